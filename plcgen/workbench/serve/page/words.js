// Labels of the page, a table for each language. Messages, titles and facts come from the server and are English.
import de, { SAID } from "./words.de.js";
import en from "./words.en.js";

const TABLES = { en, de };
const asked = (() => {
  try {
    return localStorage.getItem("plcgen.language");
  } catch {
    return null;
  }
})();
export let language = asked in TABLES ? asked : navigator.language.startsWith("de") ? "de" : "en";

export function word(key) {
  return TABLES[language][key] ?? key;
}

// A word of the server with a label of the page, if it has one.
export function named(group, key, otherwise = key.replace(/_/g, " ")) {
  return TABLES[language][`${group}_${key}`] ?? otherwise;
}

// A fixed text of the server, in German if that is known; numbers and what stands in quotation marks stay.
export function said(text) {
  const parts = [];
  const found = language === "de" && SAID[text.replace(/"[^"]*"|\d+/g, (part) => `#${parts.push(part) && ""}`)];
  return found ? found.replace(/#/g, () => parts.shift()) : text;
}

export function speak(next) {
  language = next;
  try {
    localStorage.setItem("plcgen.language", next);
  } catch { /* a browser without storage forgets it */ }
  label(document);
}

export function label(within) {
  document.documentElement.lang = language;
  for (const one of within.querySelectorAll("[data-word]")) one.textContent = word(one.dataset.word);
  for (const one of within.querySelectorAll("[data-title]")) one.title = word(one.dataset.title);
}
