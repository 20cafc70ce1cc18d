// The dialog for a new spec: what it is for, and the names and numbers that stand in it.
import { $, fill, h, option, field } from "./dom.js";
import { ask, attempt } from "./ask.js";
import { named, word } from "./words.js";
import { deviceFields } from "./form.js";

export function newSpec(desk, take) {
  const { families, specs } = desk.folder;
  const number = (name, value) => h("input", { name, value, inputmode: "numeric", size: 6, pattern: "[0-9]*" });
  const name = h("input", { name: "name", value: free(specs), required: true, pattern: ".+\\.ya?ml", size: 24 });
  const title = h("input", { name: "title", value: word("myStation"), required: true, size: 24 });
  const { device, object, rule } = deviceFields(desk, "sinamics-s120");
  device.prepend(option("ppi", word("ppiMaster")));
  const family = h("select", { name: "family" }, families.map((one) => option(one.key, one.key, one.key === "s7-1500")));
  const toolchain = h("select", { name: "toolchain" });
  const key = h("input", { name: "key", value: "drive1", required: true, size: 12 });
  const address = number("address", "270");
  const keyField = field("", key), addressField = field("", address), objectField = field(word("driveObject"), object);
  const starts = h("fieldset", { class: "chips" }), said = h("div", {});
  const port = number("port", "270"), read = h("input", { name: "read", value: "VW100", size: 8 });
  const stationFields = [field(word("port"), port), field(word("reads"), read)];
  const reason = h("small", { class: "rule" });
  const say = (one, text) => { one.firstChild.textContent = text; };

  function draw() {
    const chosen = families.find((one) => one.key === family.value), ppi = device.value === "ppi", before = toolchain.value || "tia-v17";
    fill(toolchain, Object.entries(chosen.tools).map(([tool, why]) => h("option", { value: tool, disabled: why !== "", title: why }, why ? `${tool}: ${why}` : tool)));
    toolchain.value = chosen.tools[before] === "" ? before : Object.keys(chosen.tools).find((tool) => chosen.tools[tool] === "");
    for (const one of [objectField, rule]) one.hidden = ppi;
    for (const one of stationFields) one.hidden = !ppi;
    port.value = chosen.classic ? "256" : "270";
    const jobs = desk.folder.devices.find((one) => one.key === device.value)?.jobs ?? [];
    starts.hidden = jobs.length < 2;
    fill(starts, h("legend", {}, word("beginWith")), jobs.map((one) => h("label", {}, h("input", { type: "checkbox", name: "jobs", value: one, checked: true }), named("start", one.replace("-", "_")))));
    say(keyField, word(ppi ? "station" : "drive"));
    say(addressField, word(ppi ? "ppiAddress" : chosen.classic ? "logicalAddress" : "hardwareId"));
    if (["drive1", "s7_200"].includes(key.value)) key.value = ppi ? "s7_200" : "drive1";
    if (["270", "256", "2"].includes(address.value)) address.value = ppi ? "2" : chosen.classic ? "256" : "270";
    reason.textContent = word(ppi ? "whereStation" : "whereAddress");
  }

  for (const one of [device, family]) one.addEventListener("change", draw);
  draw();
  const dialog = $("#dialog");
  const create = async (event) => {
    event.preventDefault();
    const given = Object.fromEntries([title, device, family, toolchain, key, address, object, port, read].map((one) => [one.name, one.value]));
    if (!starts.hidden) given.jobs = [...starts.querySelectorAll(":checked")].map((one) => one.value).join(",");
    fill(said);
    const found = await attempt(() => ask("new", { name: name.value, given }), said);
    if (!found || (desk.dirty && !confirm(word("leave")))) return;
    dialog.close();
    take(found);
  };
  fill(dialog, h("h2", {}, word("newTitle")), h("form", { onsubmit: create, novalidate: true },
    field(word("file"), name), field(word("station_"), title), field(word("device"), device), field(word("family"), family), field(word("toolchain"), toolchain),
    keyField, addressField, reason, stationFields, objectField, rule, starts, said,
    h("div", { class: "buttons" }, h("button", { class: "main", type: "submit" }, word("create")),
      h("button", { type: "button", onclick: () => dialog.close() }, word("cancel")))));
  dialog.showModal();
}

function free(specs) {
  let number = 1;
  const name = () => (number === 1 ? "job.yaml" : `job${number}.yaml`);
  while (specs.includes(name())) number += 1;
  return name();
}
