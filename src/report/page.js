// Read-outs of the plots and the time slider. Without it the page shows the same figures, standing still.
"use strict";
(() => {
  const NEAR = 24; // How far from a line its values are still read off, px of the drawing.
  const RUN = 8000; // Time that all frames take, ms.

  const number = (value) =>
    Number.isFinite(value) ? String(Number(value.toPrecision(4))).replaceAll("-", "\u2212") : "\u2013";

  // "stress (MPa)" and 12.3 as "stress 12.3 MPa".
  function quantity(label, value) {
    const [, name, unit] = label.match(/^(.*?)(?: \(([^()]*)\))?$/);
    return `${name} ${number(value)} ${unit ?? ""}`.trimEnd();
  }

  // An axis of a plot: `value` at a place of the drawing, and `place` of a value.
  function axis(plot, name, start, end) {
    const [low, high, kind] = plot.dataset[name].split(" ");
    const to = kind === "log" ? Math.log : (value) => value;
    const from = kind === "log" ? Math.exp : (value) => value;
    const [first, last] = [to(Number(low)), to(Number(high))];
    return {
      label: plot.dataset[name + "Label"],
      value: (place) => from(first + ((last - first) * (place - start)) / (end - start)),
      place: (value) => start + ((end - start) * (to(value) - first)) / (last - first),
      holds: (value) => to(value) >= first && to(value) <= last,
    };
  }

  function plotOf(rect) {
    const [left, top, width, height] = ["x", "y", "width", "height"].map((name) => Number(rect.getAttribute(name)));
    const [right, bottom] = [left + width, top + height];
    return {
      svg: rect.ownerSVGElement, left, top, right, bottom,
      x: axis(rect, "x", left, right),
      y: axis(rect, "y", bottom, top),
      has: (at) => at.x >= left && at.x <= right && at.y >= top && at.y <= bottom,
    };
  }

  const plots = [...document.querySelectorAll("rect.plot")].map(plotOf);

  function add(svg, name, attributes) {
    const element = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    return svg.appendChild(element);
  }

  // The lines of a path, each a list of points.
  const lines = (path) =>
    path.getAttribute("d").split("M").slice(1).map((line) => line.split("L").map((pair) => pair.split(" ").map(Number)));

  // The point of a straight piece that is nearest to a place.
  function nearestOn([x0, y0], [x1, y1], at) {
    const [dx, dy] = [x1 - x0, y1 - y0];
    const part = ((at.x - x0) * dx + (at.y - y0) * dy) / (dx * dx + dy * dy || 1);
    const inside = Math.min(Math.max(part, 0), 1);
    return { x: x0 + inside * dx, y: y0 + inside * dy };
  }

  // The nearest point of all lines and marks, with the name of its line; none where all are far off.
  function nearest(plot, at) {
    let best = { distance: NEAR };
    const offer = (point, name) => {
      const distance = Math.hypot(point.x - at.x, point.y - at.y);
      if (distance < best.distance && plot.has(point)) best = { ...point, name, distance };
    };
    for (const path of plot.svg.querySelectorAll("g[clip-path]:not(.on-map *) > path")) {
      for (const line of lines(path)) {
        line.forEach((point, i) => offer(nearestOn(line[Math.max(i - 1, 0)], point, at), path.dataset.name));
      }
    }
    for (const mark of plot.svg.querySelectorAll("g[clip-path]:not(.on-map *) > circle")) {
      offer({ x: Number(mark.getAttribute("cx")), y: Number(mark.getAttribute("cy")) });
    }
    return best.distance < NEAR ? best : null;
  }

  const box = document.body.appendChild(document.createElement("div"));
  box.className = "readout";
  box.hidden = true;
  let marker = null;

  function hide() {
    box.hidden = true;
    marker?.remove();
    marker = null;
  }

  // What is to be said of a place in a plot, at most at the point of a line.
  function read(plot, at) {
    const point = nearest(plot, at);
    const { x, y } = point ?? at;
    const said = [quantity(plot.x.label, plot.x.value(x)), quantity(plot.y.label, plot.y.value(y))];
    if (point?.name) said.unshift(point.name);
    const isMap = plot.svg.querySelector("image") !== null;
    if (isMap && player) said.push(quantity(player.label, player.value(plot.x.value(x), plot.y.value(y))));
    return { point, text: said.join("\n") };
  }

  function show(event) {
    const svg = event.target.closest?.("svg");
    const matrix = svg?.getScreenCTM();
    const at = matrix && new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
    const plot = at && plots.find((plot) => plot.svg === svg && plot.has(at));
    hide();
    if (!plot) return;
    const { point, text } = read(plot, at);
    if (point) marker = add(svg, "circle", { class: "marker", cx: point.x, cy: point.y, r: 4 });
    box.textContent = text;
    box.hidden = false;
    const { width, height } = box.getBoundingClientRect();
    const left = event.clientX + 14 + width < innerWidth ? event.clientX + 14 : event.clientX - 14 - width;
    box.style.left = `${Math.max(left, 4)}px`;
    box.style.top = `${Math.max(event.clientY - 14 - height, 4)}px`;
  }
  for (const kind of ["pointermove", "pointerdown"]) document.addEventListener(kind, show);
  document.addEventListener("scroll", hide, { passive: true });
  // A finger leaves as soon as it is lifted; what it has tapped stays.
  document.documentElement.addEventListener("pointerleave", (event) => event.pointerType === "mouse" && hide());

  const floats = (text) => new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);

  function closest(list, value) {
    let best = 0;
    list.forEach((item, i) => { if (Math.abs(item - value) < Math.abs(list[best] - value)) best = i; });
    return best;
  }

  // The profile of one instant, chosen by a slider.
  function start(figure) {
    const data = JSON.parse(figure.querySelector("script").textContent);
    const [time, x, values] = [data.time, data.x, data.values].map(floats);
    const plot = plots.find((plot) => plot.svg === figure.querySelector("svg"));
    const path = figure.querySelector("g[clip-path] > path");
    const [slider, button, output] = ["input", "button", "output"].map((name) => figure.querySelector(name));
    const row = (frame) => values.subarray(frame * x.length, (frame + 1) * x.length);

    const cursors = plots.flatMap((plot) => [
      ...(plot.x.label === data.label ? [{ plot, axis: plot.x, ends: ["x1", "x2"], y1: plot.top, y2: plot.bottom }] : []),
      ...(plot.y.label === data.label ? [{ plot, axis: plot.y, ends: ["y1", "y2"], x1: plot.left, x2: plot.right }] : []),
    ]).map(({ plot, axis, ends, ...fixed }) => ({ axis, ends, line: add(plot.svg, "line", { class: "cursor", ...fixed }) }));

    function draw() {
      const frame = Number(slider.value);
      let d = "";
      let down = false;
      row(frame).forEach((value, i) => {
        if (Number.isFinite(value)) {
          d += `${down ? "L" : "M"}${plot.x.place(x[i]).toFixed(2)} ${plot.y.place(value).toFixed(2)}`;
        }
        down = Number.isFinite(value);
      });
      path.setAttribute("d", d);
      output.textContent = quantity(data.label, time[frame]);
      slider.setAttribute("aria-valuetext", output.textContent);
      for (const { axis, ends, line } of cursors) {
        line.style.display = axis.holds(time[frame]) ? "" : "none";
        for (const end of ends) line.setAttribute(end, axis.place(time[frame]));
      }
    }

    let timer = 0;
    function pause() {
      clearInterval(timer);
      timer = 0;
      button.textContent = "\u25b6\ufe0e";
      button.setAttribute("aria-label", "Play");
    }
    function play() {
      if (slider.value === slider.max) slider.value = 0;
      timer = setInterval(() => {
        slider.value = Number(slider.value) + 1;
        if (slider.value === slider.max) pause();
        draw();
      }, Math.min(Math.max(RUN / time.length, 40), 400));
      button.textContent = "\u23f8\ufe0e";
      button.setAttribute("aria-label", "Pause");
    }
    button.addEventListener("click", () => (timer ? pause() : play()));
    slider.addEventListener("input", () => { pause(); draw(); });
    pause();
    draw();
    figure.querySelector(".controls").hidden = false;
    return { label: plot.y.label, value: (place, instant) => row(closest(time, instant))[closest(x, place)] };
  }

  const figure = document.querySelector(".player");
  const player = figure && start(figure);
})();
