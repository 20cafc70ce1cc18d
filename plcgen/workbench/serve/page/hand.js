// What somebody sets by hand in a run: inputs of jobs and values of partners with unit and limits; faults with the keys that count.
import { fill, h, option, field } from "./dom.js";
import { named, word } from "./words.js";

// A field for each value, which goes out when it is left or Enter is pressed; a refused one stays, with the reason below it.
export function valueFields(list, values, put, titled = false) {
  return list.map((one) => {
    const limits = [one.low ?? null, one.high ?? null].some((each) => each !== null) ? `${one.low ?? ""} .. ${one.high ?? ""}` : "";
    const box = h("label", { class: "input" });
    const send = async (value) => box.classList.toggle("wrong", !await put(`${one.path.replace(/"/g, "")}=${value}`, box));
    const now = values[one.path] ?? "";
    const about = { "aria-label": one.name, "data-path": one.path, title: [one.title, one.type, limits].filter(Boolean).join("\n") };
    const control = one.type?.toUpperCase() === "BOOL"
      ? h("input", { type: "checkbox", checked: now === "TRUE", onchange: (event) => send(event.target.checked ? "TRUE" : "FALSE"), ...about })
      : one.names?.length
        ? h("select", { onchange: (event) => send(event.target.value), ...about }, one.names.some(([, number]) => Number(now) === number) ? null : option(now, now, true), one.names.map(([name, number]) => option(String(number), `${number} ${name}`, Number(now) === number)))
        : h("input", { class: "value", value: now, onchange: (event) => { event.target.blur(); send(event.target.value); }, ...about });
    return fill(box, h("span", {}, one.name), control, h("small", {}, [one.unit || one.type, limits].filter(Boolean).join(" ")), titled && one.title ? h("small", { class: "about" }, one.title) : null);
  });
}

// The values as they are now; not where somebody types, or is told what is wrong.
export function renew(within, values) {
  for (const one of within.querySelectorAll("[data-path]")) {
    if (one === document.activeElement || one.closest(".wrong")) continue;
    if (one.type === "checkbox") one.checked = values[one.dataset.path] === "TRUE";
    else if (one.matches("input")) one.value = values[one.dataset.path] ?? "";
    else one.value = String(Number(values[one.dataset.path]));
  }
}

// Kinds of faults as a list to choose from; only what counts for the kind is asked.
export function faultForm(kinds, strike) {
  const kind = h("select", { id: "fault-kind" }, kinds.map((one) => option(one.kind, `${one.kind.replace(/_/g, " ")}: ${named("fault", one.kind, one.text)}`)));
  const text = h("small", { class: "rule" });
  const fields = h("div", { class: "fault-keys" });
  let controls = new Map();

  function control(key) {
    if (key.choices.length) return h("select", { title: key.text }, key.choices.includes(key.default) ? null : option("", word("all")), key.choices.map((one) => option(one, one, one === key.default)));
    const id = `known-${key.key}`;
    const made = h("input", { placeholder: key.default || (key.known.length ? `${word("example")} ${key.known[0][0]}` : ""), title: key.text });
    if (key.known.length) made.setAttribute("list", id);
    return [made, key.known.length ? h("datalist", { id }, key.known.map(([value, meaning]) => option(value, meaning || value))) : null];
  }

  function draw() {
    const one = kinds.find((each) => each.kind === kind.value);
    text.textContent = one ? named("fault", one.kind, one.text) : "";
    controls = new Map((one?.keys ?? []).map((key) => [key.key, [control(key)].flat()]));
    fill(fields, (one?.keys ?? []).map((key) => h("label", { class: "input", title: key.text }, h("span", {}, key.key), controls.get(key.key), h("small", { class: "about" }, named("key", key.key, key.text)))));
  }
  kind.addEventListener("change", draw);
  draw();
  const send = (event) => {
    event.preventDefault();
    strike({ kind: kind.value, keys: Object.fromEntries([...controls].map(([key, [made]]) => [key, made.value]).filter(([, value]) => value !== "")) }, event.target);
  };
  return h("form", { class: "faults", id: "fault", onsubmit: send }, field(word("fault"), kind), text, fields, h("button", { id: "inject" }, word("inject")));
}
