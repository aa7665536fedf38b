// Plots and picture zoom of report.html. The page is complete without it: tables and pictures do not need it.
"use strict";

const data = JSON.parse(document.getElementById("data").textContent);
const states = [data.rest, ...data.steps];
const dark = matchMedia("(prefers-color-scheme: dark)");
const lightColours = ["#2f6fab", "#d9802b", "#1f8a6d", "#b04a7d", "#7a6bbf", "#a08a1c", "#4a90a4", "#8a5a44"];
const darkColours = ["#7fb6e8", "#f2ab62", "#63cfae", "#e58bb8", "#b3a6ee", "#dcc85a", "#86cbe0", "#cf9d85"];
const colours = () => (dark.matches ? darkColours : lightColours);
const shown = (value) => (Number.isFinite(value) ? Number(value.toPrecision(4)).toString() : "–");

function card(title) {
    const box = document.createElement("div");
    box.className = "card";
    const heading = document.createElement("h3");
    heading.textContent = title;
    box.append(heading);
    document.getElementById("plots").append(box);
    return box;
}

const graphs = [];

/** A plot of `rows` [x, y1, y2, ...]; `labels` names x and every y as plain text. */
function plot(title, xlabel, ylabel, labels, rows, options = {}) {
    if (rows.length < 2) return;
    const box = card(title);
    const area = document.createElement("div");
    const legend = document.createElement("div");
    area.className = "plot";
    legend.className = "plot-legend";
    box.append(area, legend);
    graphs.push(new Dygraph(area, rows, {
        // Series are called by number; names from the robot file reach the page as text only.
        labels: ["x", ...labels.map((_, i) => "s" + i)],
        xlabel, ylabel, labelsDiv: legend, legend: "always", colors: colours().slice(0, Math.max(1, labels.length)),
        legendFormatter: (state) => legendText(state, labels, xlabel, legend),
        strokeWidth: 2, drawPoints: rows.length <= 60, pointSize: 2.5, highlightCircleSize: 5, connectSeparatedPoints: true,
        gridLineColor: dark.matches ? "#2c3541" : "#e3e7ec", axisLineColor: dark.matches ? "#4a5566" : "#b9c1cb",
        axisLabelFontSize: 12, yRangePad: 8, xRangePad: 8,
        axes: { y: { axisLabelWidth: 58, valueFormatter: shown, axisLabelFormatter: shown } }, ...options,
    }));
}

function legendText(state, labels, xlabel, target) {
    target.replaceChildren();
    if (state.x !== undefined) target.append(`${xlabel} ${shown(state.x)}  `);
    state.series.forEach((series, i) => {
        const name = document.createElement("span");
        name.style.color = series.color;
        name.textContent = `● ${labels[i]}` + (state.x !== undefined && Number.isFinite(series.y) ? ` ${shown(series.y)}` : "") + "   ";
        target.append(name);
    });
    return target.innerHTML;
}

/** y over x for several series with x values of their own: one sorted table with gaps. */
function merged(series) {
    const rows = [];
    series.forEach((points, i) => points.forEach(([x, y]) => {
        const row = [x, ...series.map(() => null)];
        row[i + 1] = y;
        rows.push(row);
    }));
    return rows.sort((a, b) => a[0] - b[0]);
}

const monotone = (values) => {
    const rising = values.every((v, i) => i === 0 || v >= values[i - 1]);
    return rising || values.every((v, i) => i === 0 || v <= values[i - 1]);
};

function actuatorPlots(kind, title, ratio, load, ratioLabel, loadLabel) {
    const names = Object.keys(data.rest[kind]);
    if (names.length === 0) return;
    const series = names.map((name) => states.map((s) => [s[kind][name][ratio], s[kind][name][load]]));
    if (series.every((points) => monotone(points.map((p) => p[0])))) {
        plot(`${title} over ${ratioLabel}`, ratioLabel, loadLabel, names, merged(series));
    }
    plot(`${title} over the program`, "time", loadLabel, names,
         states.map((s) => [s.time, ...names.map((name) => s[kind][name][load])]));
}

function markerPlots() {
    const names = Object.keys(data.rest.markers);
    if (names.length === 0) return;
    const away = (s, name) => Math.hypot(...s.markers[name].map((v, k) => v - data.rest.markers[name][k]));
    plot("Distance of the markers from rest", "time", "mm", names,
         states.map((s) => [s.time, ...names.map((name) => away(s, name))]));
    if (states.length > 1) trajectories(names);
}

/** The markers' ways in the plane in which they move most. */
function trajectories(names) {
    const values = (k) => names.flatMap((name) => states.map((s) => s.markers[name][k]));
    const travel = [0, 1, 2].map((k) => names.reduce((most, name) => {
        const along = states.map((s) => s.markers[name][k]);
        return Math.max(most, Math.max(...along) - Math.min(...along));
    }, 0));
    const [a, b] = [0, 1, 2].sort((i, j) => travel[j] - travel[i]).slice(0, 2).sort();
    const [width, height, pad] = [560, 300, 46];
    const range = (k) => [Math.min(...values(k)), Math.max(...values(k))];
    const [a0, a1] = range(a), [b0, b1] = range(b);
    const scale = Math.min((width - 2 * pad) / (a1 - a0 || 1), (height - 2 * pad) / (b1 - b0 || 1));
    const x = (v) => width / 2 + (v - (a0 + a1) / 2) * scale;
    const y = (v) => height / 2 - (v - (b0 + b1) / 2) * scale;
    const box = card(`Marker paths in the ${"xyz"[a]}${"xyz"[b]} plane, mm`);
    const svg = element("svg", { viewBox: `0 0 ${width} ${height}`, width: "100%", role: "img" });
    svg.append(element("rect", { x: pad - 22, y: pad - 22, width: width - 2 * pad + 44, height: height - 2 * pad + 44, class: "frame" }));
    names.forEach((name, i) => {
        const colour = colours()[i % colours().length];
        const points = states.map((s) => [x(s.markers[name][a]), y(s.markers[name][b])]);
        svg.append(element("polyline", { points: points.map((p) => p.join(",")).join(" "), fill: "none", stroke: colour, "stroke-width": 2 }));
        points.forEach((p, k) => svg.append(element("circle", { cx: p[0], cy: p[1], r: k === points.length - 1 ? 5 : 2.2, fill: colour })));
        const end = points[points.length - 1];
        const label = element("text", { x: end[0] + 9, y: end[1] - 7 });
        label.textContent = name;
        svg.append(label);
    });
    const corner = (px, py, text, anchor) => {
        const label = element("text", { x: px, y: py, "text-anchor": anchor });
        label.textContent = text;
        svg.append(label);
    };
    const left = (v) => (v - width / 2) / scale + (a0 + a1) / 2;
    const up = (v) => (height / 2 - v) / scale + (b0 + b1) / 2;
    corner(pad - 22, height - 8, `${"xyz"[a]} = ${shown(left(pad - 22))}`, "start");
    corner(width - pad + 22, height - 8, shown(left(width - pad + 22)), "end");
    corner(pad - 22, 16, `${"xyz"[b]} = ${shown(up(height - pad + 22))} … ${shown(up(pad - 22))}`, "start");
    box.append(svg);
}

function element(name, attributes) {
    const node = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    return node;
}

function supportPlots() {
    // Where cables and loads balance inside the robot, a support carries rounding errors only: nothing to plot.
    const carries = (name) => states.some((s) => Math.hypot(...s.supports[name].force_N) > 1e-6);
    for (const name of Object.keys(data.rest.supports).filter(carries).slice(0, 6)) {
        plot(`Force of support “${name}”`, "time", "N", ["x", "y", "z"],
             states.map((s) => [s.time, ...s.supports[name].force_N]));
    }
}

function contactPlots() {
    const names = Object.keys(data.rest.contacts || {});
    for (const name of names.slice(0, 6)) {
        plot(`Force of “${name}” on the robot`, "time", "N", ["x", "y", "z"],
             states.map((s) => [s.time, ...s.contacts[name].force_N]));
    }
    if (states.some((s) => s.self_contact_N > 0)) {
        plot("Contact of the robot with itself, all forces", "time", "N", ["self-contact"],
             states.map((s) => [s.time, s.self_contact_N]));
    }
    if (states.some((s) => Number.isFinite(s.smallest_distance_mm))) {
        plot("Smallest distance of what is near", "time", "mm", ["distance"],
             states.map((s) => [s.time, s.smallest_distance_mm]), { includeZero: true });
    }
}

function solverPlots() {
    const steps = data.steps;
    plot("Iterations and substeps", "step", "", ["iterations", "substeps"],
         steps.map((s) => [s.index, s.iterations, s.substeps]), { includeZero: true });
    plot("Residual at the end of each step", "step", "", ["residual", "tolerance"],
         steps.map((s) => [s.index, Math.max(s.residual, 1e-16), data.tolerance]),
         { logscale: true, axes: { y: { axisLabelWidth: 58, valueFormatter: shown,
                                        axisLabelFormatter: (v) => v.toExponential(0) } } });
    iterationPlot();
    plot("Smallest det F", "step", "", ["min J"], states.map((s) => [s.index, s.min_J]));
}

/** Every iteration of the program, each step beginning anew; one line per solver that took part. */
function iterationPlot() {
    const holder = document.getElementById("iterations");
    if (!holder) return;
    const { solvers, rows } = JSON.parse(holder.textContent);
    const series = solvers.map((_, k) => rows.filter((row) => row[1] === k)
        .map((row) => [row[0], Math.max(row[2], 1e-16)]));
    plot("Residual of every iteration", "iteration", "", solvers, merged(series),
         { logscale: true, axes: { y: { axisLabelWidth: 58, valueFormatter: shown,
                                        axisLabelFormatter: (v) => v.toExponential(0) } } });
}

function zoom() {
    const dialog = document.createElement("dialog");
    const image = document.createElement("img");
    dialog.append(image);
    document.body.append(dialog);
    dialog.addEventListener("click", () => dialog.close());
    document.querySelectorAll("figure img").forEach((picture) => picture.addEventListener("click", () => {
        image.src = picture.src;
        image.alt = picture.alt;
        dialog.showModal();
    }));
}

function draw() {
    graphs.splice(0).forEach((graph) => graph.destroy());
    document.getElementById("plots").replaceChildren();
    actuatorPlots("cables", "Cable tension", "length_ratio", "tension_N", "length ratio", "N");
    actuatorPlots("chambers", "Chamber pressure", "volume_ratio", "pressure_kPa", "volume ratio", "kPa");
    markerPlots();
    supportPlots();
    contactPlots();
    solverPlots();
}

draw();
zoom();
dark.addEventListener("change", draw);
