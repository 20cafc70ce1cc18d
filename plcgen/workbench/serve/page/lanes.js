// Lanes of signals over scans on a canvas: only what is in sight is drawn, however long the run is.
import { h } from "./dom.js";

const HEIGHT = 20, HEAD = 22, GUTTER = 190;

export class Lanes {
  // lanes: [{ title, group, kind: "bool" | "state" | "mark", style, names, series: [[scan, value], ...] }]
  constructor(onscan) {
    this.lanes = [];
    this.scans = 0;
    this.unit = 14;
    this.marked = 0;
    this.canvas = h("canvas", { class: "lanes-canvas" });
    this.spacer = h("div", { class: "lanes-space" });
    this.box = h("div", { class: "lanes", tabindex: 0 }, this.spacer, this.canvas);
    this.box.addEventListener("scroll", () => this.draw());
    this.canvas.addEventListener("click", (event) => {
      const scan = this.scanAt(event.offsetX);
      if (scan > 0 && scan <= this.scans) onscan(scan);
    });
    this.box.addEventListener("wheel", (event) => {
      if (!event.ctrlKey) return;
      event.preventDefault();
      this.unit = Math.min(40, Math.max(2, this.unit * (event.deltaY < 0 ? 1.25 : 0.8)));
      this.size();
    }, { passive: false });
    new ResizeObserver(() => this.size()).observe(this.box);
  }

  scanAt(x) { return Math.floor((x - GUTTER + this.box.scrollLeft) / this.unit) + 1; }

  show(lanes, scans, follow = true) {
    this.lanes = lanes;
    this.scans = scans;
    this.size();
    if (follow) this.box.scrollLeft = this.box.scrollWidth;
  }

  go(scan) {
    this.marked = scan;
    this.box.scrollLeft = Math.max(0, scan * this.unit - (this.box.clientWidth - GUTTER) * 0.6);
    this.draw();
  }

  // As wide as there is room for, so that the numbers of few scans can be read.
  spread() {
    this.unit = Math.min(40, Math.max(14, (this.box.clientWidth - GUTTER - 24) / this.scans));
    this.size();
  }

  size() {
    const width = this.box.clientWidth, height = HEAD + this.lanes.length * HEIGHT + 4;
    if (!width) return;
    this.spacer.style.width = `${GUTTER + this.scans * this.unit + 24}px`;
    this.spacer.style.height = `${height}px`;
    const ratio = devicePixelRatio || 1;
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    this.canvas.style.width = `${width}px`;
    this.canvas.style.height = `${height}px`;
    this.draw();
  }

  draw() {
    const pen = this.canvas.getContext("2d"), ratio = devicePixelRatio || 1;
    const css = getComputedStyle(document.documentElement), colour = (name) => css.getPropertyValue(`--${name}`).trim();
    const width = this.canvas.width / ratio, left = this.box.scrollLeft;
    const x = (scan) => GUTTER + (scan - 1) * this.unit - left;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.fillStyle = colour("paper");
    pen.fillRect(0, 0, width, this.canvas.height);
    pen.font = "11px system-ui, sans-serif";
    pen.textBaseline = "middle";
    const first = Math.max(1, Math.floor(left / this.unit)), last = Math.min(this.scans, first + Math.ceil(width / this.unit) + 1);
    const step = [1, 2, 5, 10, 20, 50, 100, 200].find((one) => one * this.unit >= 34) ?? 500;
    for (let scan = Math.ceil(first / step) * step; scan <= last; scan += step) {
      pen.fillStyle = colour("faint");
      pen.fillRect(x(scan), HEAD, 1, this.canvas.height);
      pen.fillStyle = colour("quiet");
      pen.fillText(String(scan), x(scan) + 2, HEAD / 2);
    }
    if (this.marked) {
      pen.fillStyle = colour("mark");
      pen.fillRect(x(this.marked), 0, Math.max(this.unit, 3), this.canvas.height);
      pen.fillStyle = colour("ink");
      pen.fillText(String(this.marked), x(this.marked) + 2, HEAD / 2);
    }
    this.lanes.forEach((lane, row) => this.lane(pen, lane, HEAD + row * HEIGHT, { x, first, last, colour }));
    pen.fillStyle = colour("paper");
    pen.fillRect(0, 0, GUTTER - 4, this.canvas.height);
    this.lanes.forEach((lane, row) => {
      const y = HEAD + row * HEIGHT, top = row === 0 || this.lanes[row - 1].group !== lane.group;
      if (top) {
        pen.fillStyle = colour("line");
        pen.fillRect(0, y, width, 1);
      }
      if (top) {
        pen.fillStyle = colour("ink");
        pen.font = "600 11px system-ui, sans-serif";
        pen.fillText(lane.group, 8, y + HEIGHT / 2, GUTTER - 66);
        pen.font = "11px system-ui, sans-serif";
      }
      pen.fillStyle = colour("quiet");
      pen.textAlign = "right";
      pen.fillText(lane.title, GUTTER - 10, y + HEIGHT / 2);
      pen.textAlign = "left";
    });
  }

  lane(pen, lane, y, { x, first, last, colour }) {
    const series = lane.series;
    let place = 0;
    while (place + 1 < series.length && series[place + 1][0] <= first) place += 1;
    for (; place < series.length && series[place][0] <= last; place += 1) {
      const [scan, value] = series[place], end = series[place + 1]?.[0] ?? this.scans + 1;
      if (lane.kind === "mark") {
        pen.fillStyle = colour(lane.style);
        pen.beginPath();
        pen.arc(x(scan) + this.unit / 2, y + HEIGHT / 2, 4, 0, 7);
        pen.fill();
        continue;
      }
      if (!value && lane.kind === "bool") continue;
      const from = Math.max(x(scan), GUTTER - 4), wide = x(end) - from;
      if (wide <= 0) continue;
      pen.fillStyle = lane.kind === "bool" ? colour(lane.style) : value === 0 || value === "7000" ? colour("faint") : colour("chosen");
      pen.fillRect(from, y + 3, Math.max(wide - 1, 1), HEIGHT - 6);
      if (lane.kind === "state") {
        const text = lane.names?.[value] ?? String(value);
        if (pen.measureText(text).width + 4 < wide) {
          pen.fillStyle = colour("ink");
          pen.fillText(text, from + 3, y + HEIGHT / 2);
        }
      }
    }
  }
}

// A telegram field by field, as the server has taken it apart.
export function telegramTable(telegram, word) {
  return h("div", { class: "telegram" }, h("p", { class: "hex" }, telegram.hex.replace(/(..)/g, "$1 ")),
    h("table", { class: "dense" }, h("thead", {}, h("tr", {}, [word("offset"), word("bytes"), word("member"), word("value"), word("meaning")].map((text) => h("th", {}, text)))),
      h("tbody", {}, telegram.fields.map((one) => h("tr", { class: one.problem ? "danger" : "" }, h("td", { class: "n" }, String(one.offset)),
        h("td", { class: "hex" }, one.hex.replace(/(..)/g, "$1 ")), h("td", {}, one.name), h("td", {}, one.value), h("td", {}, one.meaning))))),
    telegram.problems.map((one) => h("p", { class: "bad" }, `${one.offset}: ${one.message}`)));
}
