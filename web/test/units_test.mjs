// The page's functions without a page: texts, numbers and packets in, texts, numbers and packets out.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';

const web = process.env.PLIANT_WEB ?? new URL('..', import.meta.url).pathname;
const sources = new URL('../src/', import.meta.url).pathname;
const require = createRequire(join(web, 'package.json'));

/// As much of a browser as the modules ask for when they are loaded.
function pretendBrowser() {
  const store = () => {
    const kept = new Map();
    return { getItem: (k) => kept.get(k) ?? null, setItem: (k, v) => kept.set(k, v) };
  };
  const define = (name, value) => Object.defineProperty(globalThis, name, { value, configurable: true, writable: true });
  define('window', globalThis);
  define('location', { hash: '', protocol: 'http:', host: 'localhost' });
  define('sessionStorage', store());
  define('localStorage', store());
  define('addEventListener', () => {});
  define('matchMedia', () => ({ matches: false, addEventListener() {} }));
  define('document', { documentElement: { dataset: {} }, addEventListener() {} });
}

const folder = mkdtempSync(join(tmpdir(), 'pliant_units_'));
after(() => rmSync(folder, { recursive: true, force: true }));

let page;
before(async () => {
  pretendBrowser();
  const modules = ['packet', 'simulate/toml_edit', 'simulate/colormap', 'simulate/tracks', 'simulate/recorder', 'print/stopped', 'print/state', 'store', 'number_field', 'make/gantt', 'make/plan', 'orbit_keys'];
  const entry = join(folder, 'entry.ts');
  writeFileSync(entry, modules.map((m) => `export * from ${JSON.stringify(join(sources, m))};`).join('\n'));
  const outfile = join(folder, 'units.mjs');
  await require('esbuild').build({ entryPoints: [entry], outfile, bundle: true, format: 'esm', platform: 'neutral', mainFields: ['module', 'main'], nodePaths: [join(web, 'node_modules')], jsx: 'automatic', jsxImportSource: 'preact', logLevel: 'error' });
  page = await import(pathToFileURL(outfile));
});

/// A packet as src/presentation/studio/packet.hpp writes it.
function packet(head, arrays) {
  const entries = Object.entries(arrays).map(([name, data]) => ({ name, type: data instanceof Float32Array ? 'f32' : 'u32', count: data.length }));
  let text = JSON.stringify({ head, arrays: entries });
  while (text.length % 4) text += ' ';
  const parts = [new Uint8Array(new Uint32Array([0x314e4c50, text.length]).buffer), new TextEncoder().encode(text), ...Object.values(arrays).map((a) => new Uint8Array(a.buffer))];
  const whole = new Uint8Array(parts.reduce((n, p) => n + p.length, 0));
  parts.reduce((at, p) => (whole.set(p, at), at + p.length), 0);
  return whole.buffer;
}

test('a packet is its head and its arrays; what is not in it is empty', () => {
  const read = page.readPacket(packet({ robot: 'bar' }, { x: new Float32Array([1, 2.5]), t: new Uint32Array([7, 8, 9]) }));
  assert.deepEqual(read.head, { robot: 'bar' });
  assert.deepEqual([...read.f32('x')], [1, 2.5]);
  assert.deepEqual([...read.u32('t')], [7, 8, 9]);
  assert.equal(read.f32('none').length, 0);
  assert.ok(read.has('x') && !read.has('none'));
});

test('a packet of something else, or one that ends early, is refused', () => {
  assert.throws(() => page.readPacket(new TextEncoder().encode('<html></html>').buffer), /not a packet/);
  const whole = packet({}, { x: new Float32Array(4) });
  assert.throws(() => page.readPacket(whole.slice(0, 6)));
  assert.throws(() => page.readPacket(whole.slice(0, 12)));
  assert.throws(() => page.readPacket(whole.slice(0, whole.byteLength - 4)).f32('x'));
});

const robot = `name = "x"
[material.soft]  # the finger
youngs_modulus = "1 MPa"  # measured
poisson_ratio=0.45
curve = ["1 MPa", "2 MPa"] # two
[material.softer]
youngs_modulus = "9 MPa"
`;

test('one number of a table changes, and nothing else', () => {
  assert.equal(page.setKey(robot, 'material.soft', 'youngs_modulus', '"2 MPa"'), robot.replace('"1 MPa"  #', '"2 MPa"  #'));
  assert.equal(page.setKey(robot, 'material.soft', 'poisson_ratio', '0.3'), robot.replace('0.45', '0.3'));
  assert.equal(page.setKey(robot, 'material.soft', 'curve', '3'), robot.replace('["1 MPa", "2 MPa"]', '3'));
  assert.equal(page.setKey(robot, 'material.softer', 'youngs_modulus', '"2 MPa"'), robot.replace('"9 MPa"', '"2 MPa"'));
});

test('a key that the table has not is added to it, not to the next', () => {
  const changed = page.setKey(robot, 'material.soft', 'density', '"1 g/cm^3"');
  assert.equal(changed, robot.replace('# the finger\n', '# the finger\ndensity = "1 g/cm^3"\n'));
  assert.equal(page.setKey(robot, 'material.hard', 'density', '1'), null);
  assert.equal(page.setKey(robot, 'material.sof.', 'density', '1'), null); // no pattern
});

test('tables in one line, and names in quotes', () => {
  const line = 'material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.45 } # x';
  assert.equal(page.setKey(line, 'material.soft', 'poisson_ratio', '0.3'), line.replace('0.45', '0.3'));
  assert.equal(page.setKey(line, 'material.soft', 'youngs_modulus', '"3 MPa"'), line.replace('"1 MPa"', '"3 MPa"'));
  assert.equal(page.setKey(line, 'material.soft', 'density', '5'), line.replace('0.45 }', '0.45, density = 5 }'));
  assert.equal(page.setKey('[material."soft"]\na = 1', 'material.soft', 'a', '2'), '[material."soft"]\na = 2');
});

test('a number is set by the path that --set has, in tables and in entries of lists by their name', () => {
  const file = '[material.soft]\nyoungs_modulus = "1 MPa"\n\n[[cable]]\nname = "left"\nfriction = 0.1\n\n[[cable]]\nname = "right" # the other\nfriction = 0.2\n[contact]\nfriction = 0.3\n';
  assert.equal(page.assign(file, 'material.soft.youngs_modulus', '"2 MPa"'), file.replace('1 MPa', '2 MPa'));
  assert.equal(page.assign(file, 'cable.right.friction', '0.5'), file.replace('0.2', '0.5'));
  assert.equal(page.assign(file, 'cable.left.target.offset', '"1 mm"'), file.replace('name = "left"\n', 'name = "left"\ntarget.offset = "1 mm"\n'));
  assert.equal(page.assign(file, 'contact.friction', '0'), file.replace('0.3', '0'));
  assert.equal(page.assign(file, 'cable.middle.friction', '0'), null);
  assert.equal(page.assign(file, 'chamber.left.friction', '0'), null);
});

test('the colours of a field are those of the pictures, and stop at the ends', () => {
  assert.deepEqual(page.fieldColour(0), [0.267, 0.004, 0.329]);
  assert.deepEqual(page.fieldColour(1), [0.992, 0.906, 0.145]);
  assert.deepEqual(page.fieldColour(-3), page.fieldColour(0));
  assert.deepEqual(page.fieldColour(9), page.fieldColour(1));
  assert.deepEqual(page.fieldColour(NaN), page.fieldColour(0));
  page.fieldColour(0.25).forEach((v, i) => assert.ok(Math.abs(v - [0.2355, 0.29, 0.51][i]) < 1e-12));
  assert.match(page.gradientCss(), /^linear-gradient\(to top, rgb\(68 1 84\) 0%, .*100%\)$/);
});

test('times, steps of time, and ranges in words', () => {
  assert.deepEqual([0, 59.6, 3599.5, 360000].map(page.clock), ['0:00:00', '0:01:00', '1:00:00', '100:00:00']);
  for (const [span, most, step] of [[10, 10, 1], [11, 10, 2], [3600, 6, 600], [86400 * 30, 10, 259200]]) assert.equal(page.timeStep(span, most), step);
  assert.equal(page.rangeText({ from: 0, to: 1 }, 'mm'), 'must be from 0 to 1 mm');
  assert.equal(page.rangeText({ from: 0, to: Infinity, open: true }, ''), 'must be more than 0');
  assert.equal(page.rangeText({ from: -Infinity, to: Infinity }, 'N'), 'must be a number');
  assert.ok(page.inRange(0, { from: 0, to: 1 }) && !page.inRange(0, { from: 0, to: 1, open: true }));
  for (const v of [NaN, Infinity, 1.1]) assert.ok(!page.inRange(v, { from: 0, to: 1 }));
  assert.equal(page.restValue('length_ratio'), 1);
  assert.equal(page.restValue('tension_N'), 0);
});

const actuators = [{ name: 'flexor', type: 'cable', kind: 'tension_N' }, { name: 'air "1"', type: 'chamber', kind: 'volume_ratio' }];

/// What asProgram() makes of these values of the flexor, 0.2 s apart, as [time, value].
function program(values) {
  page.scene.value = { head: { actuators: [actuators[0]], markers: [] } };
  page.recorded.value = values.map((value, i) => ({ time: 0.2 * i, values: { flexor: { kind: 'tension_N', value } } }));
  return [...page.asProgram().matchAll(/time = "([\d.]+) s"\nflexor = "([-\d.]+) N"/g)].map((m) => [Number(m[1]), Number(m[2])]);
}

test('a recording in a straight line is its end; a corner stays', () => {
  assert.deepEqual(program([0, 1, 2, 3, 4]), [[0.8, 4]]);
  assert.deepEqual(program([0, 1, 2, 2, 2]), [[0.4, 2], [0.8, 2]]);
  assert.deepEqual(program([1]), []);
});

test('a recording that bends slowly keeps its way to a thousandth', () => {
  const values = Array.from({ length: 101 }, (_, i) => (0.2 * i) ** 2);
  const kept = [[0, 0], ...program(values)];
  assert.ok(kept.length < 60, `${kept.length} keys of 101`);
  values.forEach((value, i) => {
    const t = 0.2 * i;
    const k = Math.max(1, kept.findIndex(([time]) => time >= t - 1e-9));
    const [[t0, v0], [t1, v1]] = [kept[k - 1], kept[k]];
    const there = v0 + ((t - t0) / (t1 - t0)) * (v1 - v0);
    assert.ok(Math.abs(there - value) < 0.002 * Math.max(value, 1), `at ${t} s: ${there}, recorded ${value}`);
  });
});

test('what was driven by another measure before does not become a key', () => {
  page.scene.value = { head: { actuators, markers: [] } };
  const key = (time, kind, value) => ({ time, values: { flexor: { kind, value }, 'air "1"': { kind: 'volume_ratio', value: 1.5 } } });
  page.recorded.value = [key(0, 'length_ratio', 1), key(0.2, 'tension_N', 3), key(0.4, 'tension_N', 4.000001)];
  assert.equal(page.asProgram(), '[[program.key]]\ntime = "0.20 s"\nflexor = "3 N"\n"air \\"1\\"" = 1.5\n\n[[program.key]]\ntime = "0.40 s"\nflexor = "4 N"\n"air \\"1\\"" = 1.5');
});

test('what the plots show, as a table with names in quotes', () => {
  const marker = { name: 'tip', rest: [0, 0, 0] };
  page.scene.value = { head: { actuators, markers: [marker] } };
  const frame = (sequence, x) => ({ head: { revision: 77, sequence, cables: [{ tension_N: x }], chambers: [{ pressure_kPa: 2 * x }], markers: [[x, 0, 0]], residual: 0 } });
  page.frame.value = frame(1, 3);
  page.frame.value = frame(1, 3); // the same state again
  page.frame.value = frame(2, 4);
  const rows = page.tracksCsv(page.scene.value.head).trimEnd().split('\r\n');
  assert.equal(rows[0], 'seconds,"flexor_tension_N","air ""1""_pressure_kPa","tip_x_mm","tip_y_mm","tip_z_mm",residual');
  assert.equal(rows.length, 3);
  assert.match(rows[1], /^0\.0000,3,6,3,0,0,1e-16$/);
  assert.match(rows[2], /^\d+\.\d{4},4,8,4,0,0,1e-16$/);
  assert.deepEqual(page.tracks.markers, [[3, 4]]);
  page.frame.value = { head: { ...frame(1, 5).head, revision: 78 } }; // another robot begins anew
  assert.deepEqual(page.tracks.markers, [[5]]);
});

test('a stop is told by what happened: asked for, the firmware\'s own, or none', () => {
  const now = (message, error = true, canResume = false) => ({ state: { text: '', message, flags: { error } }, job: { canResume }, progress: {}, events: [] });
  page.info.value = { twin: true };
  page.events.value = [];
  page.now.value = now('Printer halted. kill() called!', false);
  assert.equal(page.stopOf(), null);
  page.now.value = now('the port is gone');
  assert.equal(page.stopOf(), null);
  page.now.value = now('Error:Printer halted. kill() called!', true, true);
  assert.deepEqual(page.stopOf(), { title: 'The firmware has stopped the machine', text: 'The light is off and nothing moves. Check the machine; then press Resume.', cause: 'Error:Printer halted. kill() called!' });
  page.events.value = [{ kind: 'error', text: 'emergency stop by the page' }];
  assert.equal(page.stopOf().title, 'Emergency stop');
  // One before the last connection is long over.
  page.events.value = [...page.events.value, { kind: 'state', text: 'Operational' }];
  assert.equal(page.stopOf().title, 'The firmware has stopped the machine');
  page.info.value = { twin: false };
  assert.match(page.stopOf().text, /reset its board/);
});

test('keys turn a view; other keys are left to the page', () => {
  const turns = [];
  let home = 0;
  let kept = 0;
  const press = (key) => page.orbitKeys({ key, preventDefault: () => ++kept }, (...t) => turns.push(t), () => ++home);
  for (const key of ['ArrowLeft', 'ArrowUp', '+', 'Home', 'a', 'Tab']) press(key);
  assert.deepEqual(turns, [[-0.12, 0, 1], [0, 0.12, 1], [0, 0, 0.9]]);
  assert.equal(home, 1);
  assert.equal(kept, 4);
});
