// Questions to the server; the secret of the address is in every relative path.
import { $, h } from "./dom.js";
import { said, word } from "./words.js";

export class Refused extends Error {
  constructor(problems) {
    super(problems.map((one) => one.message).join("; "));
    this.problems = problems;
  }
}

async function post(path, given, signal) {
  let answer;
  try {
    answer = await fetch(path, {
      method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(given), signal,
    });
  } catch (problem) {
    if (problem.name === "AbortError") throw problem;
    throw new Refused([{ severity: "error", message: word("gone") }]);
  }
  if (answer.ok) return answer;
  let problems = [{ severity: "error", message: `${answer.status} ${answer.statusText}` }];
  if (answer.headers.get("content-type")?.includes("json")) problems = (await answer.json()).problems;
  throw new Refused(problems);
}

export async function ask(question, given = {}, signal = undefined) {
  return (await post(`ask/${question}`, given, signal)).json();
}

export async function download(path, given, name) {
  const address = URL.createObjectURL(await (await post(path, given)).blob());
  const link = h("a", { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}

export function tell(text, level = "note", help = "") {
  const one = h("div", { class: `notice ${level}` }, h("div", {}, text), help ? h("small", {}, help) : null,
    h("button", { class: "plain", title: word("close"), onclick: () => one.remove() }, "\u00d7"));
  $("#notices").append(one);
  setTimeout(() => one.remove(), level === "error" ? 15000 : 6000);
}

// What a question raises is shown; a newer question that replaced it is no problem.
export async function attempt(call, into = undefined) {
  try {
    return await call();
  } catch (problem) {
    if (problem.name === "AbortError") return undefined;
    if (!(problem instanceof Refused)) throw problem;
    for (const one of problem.problems) {
      const place = one.line ? ` (${one.file}:${one.line})` : one.file ? ` (${one.file})` : "";
      const text = `${one.code && one.code !== "PG901" ? `${one.code}: ` : ""}${said(one.message)}${into ? "" : place}`, help = one.help ? said(one.help) : "";
      if (into) into.append(h("p", { class: "bad" }, text, help ? h("small", {}, ` ${help}`) : null));
      else tell(text, one.severity ?? "error", help);
    }
    return undefined;
  }
}
