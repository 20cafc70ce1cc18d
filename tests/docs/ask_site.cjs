// Asks the search of a built site: node ask_site.cjs SITE < questions.json, the addresses of the first pages as JSON.
// It is the script of the theme that a browser runs as a worker, here with what it needs of a browser.
const fs = require("fs");
const path = require("path");
const vm = require("vm");

const site = process.argv[2];
const run = (file) => vm.runInThisContext(fs.readFileSync(file, "utf8"), file);
const workers = path.join(site, "assets/javascripts/workers");
let hear;
let answer;
globalThis.self = globalThis;
globalThis.addEventListener = (_, listener) => (hear = listener);
globalThis.postMessage = (message) => answer(message);
globalThis.importScripts = (...names) => names.forEach((name) => run(path.join(workers, name)));
class Worker {
  postMessage(data) {
    return new Promise((resolve) => {
      answer = resolve;
      hear({ data });
    });
  }
}
globalThis.Worker = Worker;
run(path.join(workers, fs.readdirSync(workers).find((name) => name.endsWith(".js"))));
run(path.join(site, "search.js"));

(async () => {
  const worker = new Worker();
  const index = JSON.parse(fs.readFileSync(path.join(site, "search/search_index.json"), "utf8"));
  await worker.postMessage({ type: 0, data: { ...index, options: {} } });
  const found = [];
  for (const question of JSON.parse(fs.readFileSync(0, "utf8"))) {
    const { items } = (await worker.postMessage({ type: 2, data: question })).data;
    found.push(items.length ? items[0][0].location : "");
  }
  process.stdout.write(JSON.stringify(found));
})();
