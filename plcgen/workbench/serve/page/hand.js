// What somebody sets by hand in a run: inputs of a job with type, unit and limits; faults with the keys that count.
import { fill, h, option, field } from "./dom.js";
import { named, word } from "./words.js";

// A field for each input of a job; a value goes out when it is left or Enter is pressed.
export function inputFields(job, values, put) {
  return job.inputs.map((one) => {
    const limits = [one.low, one.high].some((each) => each !== null) ? `${one.low ?? ""} .. ${one.high ?? ""}` : "";
    const send = (value) => put(`${one.path.replace(/"/g, "")}=${value}`);
    const now = values[one.path] ?? "";
    const about = { "aria-label": one.name, "data-path": one.path, title: [one.title, one.type, limits].filter(Boolean).join("\n") };
    const control = one.type.toUpperCase() === "BOOL"
      ? h("input", { type: "checkbox", checked: now === "TRUE", onchange: (event) => send(event.target.checked ? "TRUE" : "FALSE"), ...about })
      : one.names.length
        ? h("select", { onchange: (event) => send(event.target.value), ...about }, one.names.some(([, number]) => Number(now) === number) ? null : option(now, now, true), one.names.map(([name, number]) => option(String(number), `${number} ${name}`, Number(now) === number)))
        : h("input", { class: "value", value: now, onchange: (event) => { event.target.blur(); send(event.target.value); }, ...about });
    return h("label", { class: "input" }, h("span", {}, one.name), control, h("small", {}, [one.unit, one.unit ? "" : one.type, limits].filter(Boolean).join(" ")));
  });
}

// The values as they are now; not where somebody types.
export function renew(within, values) {
  for (const one of within.querySelectorAll("[data-path]")) {
    if (one === document.activeElement) continue;
    if (one.type === "checkbox") one.checked = values[one.dataset.path] === "TRUE";
    else if (one.matches("input")) one.value = values[one.dataset.path] ?? "";
    else one.value = String(Number(values[one.dataset.path]));
  }
}

// Kinds of faults as a list to choose from; only what counts for the kind is asked.
export function faultForm(kinds, strike) {
  const kind = h("select", { id: "fault-kind" }, kinds.map((one) => option(one.kind, one.kind.replace(/_/g, " "))));
  const text = h("small", { class: "rule" });
  const fields = h("div", { class: "fault-keys" });
  let controls = new Map();

  function control(key) {
    if (key.choices.length) return h("select", { title: key.text }, key.choices.includes(key.default) ? null : option("", word("all")), key.choices.map((one) => option(one, one, one === key.default)));
    const id = `known-${key.key}`;
    const made = h("input", { placeholder: key.default, title: key.text });
    if (key.known.length) made.setAttribute("list", id);
    return [made, key.known.length ? h("datalist", { id }, key.known.map(([value, meaning]) => option(value, meaning || value))) : null];
  }

  function draw() {
    const one = kinds.find((each) => each.kind === kind.value);
    text.textContent = one ? named("fault", one.kind, one.text) : "";
    controls = new Map((one?.keys ?? []).map((key) => [key.key, [control(key)].flat()]));
    fill(fields, (one?.keys ?? []).map((key) => h("label", { class: "input", title: key.text }, h("span", {}, key.key), controls.get(key.key), h("small", {}, named("key", key.key, key.text)))));
  }
  kind.addEventListener("change", draw);
  draw();
  const send = (event) => {
    event.preventDefault();
    strike({ kind: kind.value, keys: Object.fromEntries([...controls].map(([key, [made]]) => [key, made.value]).filter(([, value]) => value !== "")) });
  };
  return h("form", { class: "faults", id: "fault", onsubmit: send }, field(word("fault"), kind), text, fields, h("button", { id: "inject" }, word("inject")));
}
