// The page's functions without a page: texts, numbers and packets in, texts, numbers and packets out.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
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
  define('document', { documentElement: { dataset: {}, style: {} }, addEventListener() {} });
}

const folder = mkdtempSync(join(tmpdir(), 'pliant_units_'));
after(() => rmSync(folder, { recursive: true, force: true }));

let page;
before(async () => {
  pretendBrowser();
  const modules = ['packet', 'simulate/toml_edit', 'simulate/colormap', 'simulate/tracks', 'simulate/fit', 'simulate/robot_keys', 'simulate/recorder', 'print/stopped', 'print/state', 'store', 'number_field', 'counted', 'make/gantt', 'make/plan', 'make/place', 'make/order', 'make/paint', 'make/stale', 'make/wrong', 'simulate/exact', 'simulate/kept_texts', 'simulate/program_time', 'simulate/actuators', 'print/telling', 'orbit_keys', 'simulate/gif', 'simulate/response', 'simulate/geometry', 'simulate/motion', 'simulate/workspace', 'simulate/goal', 'simulate/editor'];
  const entry = join(folder, 'entry.ts');
  writeFileSync(entry, modules.map((m) => `export * from ${JSON.stringify(join(sources, m))};`).concat(`export { setParameter } from ${JSON.stringify(join(sources, 'simulate/build'))};`).join('\n'));
  const outfile = join(folder, 'units.mjs');
  await require('esbuild').build({ entryPoints: [entry], outfile, bundle: true, format: 'esm', platform: 'neutral', mainFields: ['module', 'main'], nodePaths: [join(web, 'node_modules')], jsx: 'automatic', jsxImportSource: 'preact', logLevel: 'error' });
  page = await import(pathToFileURL(outfile));
});

/// A packet as src/presentation/scene/packet.hpp writes it.
function packet(head, arrays) {
  const entries = Object.entries(arrays).map(([name, data]) => ({ name, type: data instanceof Float32Array ? 'f32' : 'u32', count: data.length }));
  let text = JSON.stringify({ head, arrays: entries });
  while (text.length % 4) text += ' ';
  const parts = [new Uint8Array(new Uint32Array([0x314e4c50, text.length]).buffer), new TextEncoder().encode(text), ...Object.values(arrays).map((a) => new Uint8Array(a.buffer))];
  const whole = new Uint8Array(parts.reduce((n, p) => n + p.length, 0));
  parts.reduce((at, p) => (whole.set(p, at), at + p.length), 0);
  return whole.buffer;
}

test('a packet gives its head and its arrays; a missing array is empty', () => {
  const read = page.readPacket(packet({ robot: 'bar' }, { x: new Float32Array([1, 2.5]), t: new Uint32Array([7, 8, 9]) }));
  assert.deepEqual(read.head, { robot: 'bar' });
  assert.deepEqual([...read.f32('x')], [1, 2.5]);
  assert.deepEqual([...read.u32('t')], [7, 8, 9]);
  assert.equal(read.f32('none').length, 0);
  assert.ok(read.has('x') && !read.has('none'));
});

test('data that are not a packet, or that end early, are refused', () => {
  assert.throws(() => page.readPacket(new TextEncoder().encode('<html></html>').buffer), /not a packet/);
  const whole = packet({}, { x: new Float32Array(4) });
  assert.throws(() => page.readPacket(whole.slice(0, 6)));
  assert.throws(() => page.readPacket(whole.slice(0, 12)));
  assert.throws(() => page.readPacket(whole.slice(0, whole.byteLength - 4)).f32('x'));
});

test('names with dots are parts of a key in quotes', () => {
  assert.equal(page.keyOf('material', 'soft', 'density'), 'material.soft.density');
  assert.equal(page.keyOf('body', 'finger v1.2', 'material'), 'body."finger v1.2".material');
  assert.equal(page.keyOf('a', '"b"\\.c'), 'a."\\"b\\"\\\\.c"');
});

test('found values become changes of the file, with 6 digits and their unit', () => {
  assert.deepEqual(page.changeOf('cable.flexor.target.tension="4.5678901234 N"'), { key: 'cable.flexor.target.tension', value: '4.56789 N' });
  assert.deepEqual(page.changeOf('material."a=1.5".mu.0="2e6 Pa"'), { key: 'material."a=1.5".mu.0', value: '2000000 Pa' });
  assert.deepEqual(page.changeOf('cable.flexor.friction=0.123456789'), { key: 'cable.flexor.friction', value: 0.123457 });
});

test('two parameters moved right after each other are both sent', async () => {
  const sent = [];
  globalThis.fetch = async (path, options) => (sent.push([path, JSON.parse(options.body)]), { ok: true });
  page.setParameter('width', 2);
  page.setParameter('height', 3);
  page.setParameter('width', 4);
  await new Promise((r) => setTimeout(r, 400));
  assert.deepEqual(sent, [['/api/robot/set', { changes: [{ key: 'parameters.width', value: 4 }, { key: 'parameters.height', value: 3 }] }]]);
});

test('ranges of a robot that has changed are its own, but for what the user has typed', () => {
  const before = [{ name: 'a', kind: 'tension_N', low: 0, high: 7, used: false, own: { high: 7 } }, { name: 'b', kind: 'tension_N', low: 0, high: 5, used: true }];
  const now = [{ name: 'a', kind: 'tension_N', low: 1, high: 9 }, { name: 'b', kind: 'length_ratio', low: 0.5, high: 1 }];
  const next = page.renewed(now, before);
  assert.deepEqual(next.map(({ low, high, used }) => [low, high, used]), [[1, 7, false], [0.5, 1, true]]);
});

test('ticks that are near each other have as many digits as tell them apart', () => {
  const ticks = (low, high) => [0, 0.25, 0.5, 0.75, 1].map((t) => page.tickText(low + t * (high - low), (high - low) / 4));
  assert.deepEqual(ticks(0, 2), ['0', '0.5', '1', '1.5', '2']);
  assert.deepEqual(ticks(100, 100.01), ['100', '100.0025', '100.005', '100.0075', '100.01']);
  assert.equal(new Set(ticks(-0.99999, -0.99998)).size, 5);
  assert.equal(new Set(ticks(12345.6, 12345.7)).size, 5);
  assert.equal(page.tickText(3, 0), '3');
});

test('a decimal comma is refused in exposures, where it would separate two', () => {
  assert.equal(page.commaProblem({ a: { resin: '', time: '2.5', bottom: '9' } }, ['a']), '');
  assert.match(page.commaProblem({ a: { resin: '', time: '2,5', bottom: '' } }, ['a']), /^--exposure a: "2,5" has a comma/);
  assert.equal(page.commaProblem({ b: { resin: '', time: '2,5', bottom: '' } }, ['a']), '');
});

test('an error of the studio is told at its field, in words of the form instead of those of the command line', () => {
  assert.deepEqual(page.wrongOf('--layer: 0 is not a height'), { option: 'layer', value: '', text: '0 is not a height' });
  assert.deepEqual(page.wrongOf('--resin soft=: a name is needed'), { option: 'resin', value: 'soft=', text: 'a name is needed' });
  assert.equal(page.wrongOf('--drain: needs --hollow').text, 'needs “Wall thickness”');
  assert.equal(page.wrongOf('bar.toml:3: no such key'), null);
  const vat = page.wrongOf('no vat of tower holds the resin "glue" of "weich & zart": they hold a and b. Slice with --resin MATERIAL=RESIN, or with --any-vat to fill it into a free vat');
  assert.deepEqual([vat.option, vat.value], ['resin', 'glue']);
  assert.match(vat.text, /^no vat of tower holds the resin "glue" of "weich & zart": they hold a and b\. Choose another resin above, or tick “[^-]+”\.$/);
});

test('another robot does not begin with the placement, bonds and supports of the last one', () => {
  page.setOrder({ printer: 'tower', copies: 2, turn: [90, 0, 0], scale: 2, at: [3, 4], overlap: ['a+b=3,1'], support: 'a', 'any-vat': true });
  page.forgetPart();
  assert.deepEqual(page.orderJson(['a', 'b']), { printer: 'tower', copies: 2, resin: [], exposure: [], overlap: [], interlock: [] });
  page.setOrder({});
});

test('a material from the library, or one whose law has other constants, says why it cannot be changed', () => {
  const soft = { name: 'soft', law: 'neo-hookean', from_library: false, has_youngs_modulus: true };
  assert.equal(page.whyFixed(soft, 'youngs_modulus'), '');
  assert.match(page.whyFixed({ ...soft, from_library: true }, 'poisson_ratio'), /library/);
  assert.match(page.whyFixed({ ...soft, law: 'yeoh', has_youngs_modulus: false }, 'youngs_modulus'), /constants of the yeoh law/);
});

const withKeys = `name = "x" # a robot
[program]
duration = "2 s"

# how it bends
[[program.key]]      # first
time = "1 s"         # at [half] time
flexor = "2 mm"

# and back
[[program.key]]
time = "2 s"
flexor = 0
points = [
  [1, 2], # ]
  [3, 4],
]
note = """
[[program.key]]
"""

# where it is measured
[[marker]]           # the tip
name = "tip [a]"
`;

test('a program takes the place of the old one; comments, order and all else stay', () => {
  const next = page.replaceEntries(withKeys, 'program.key', '[[program.key]]\ntime = "3 s"');
  assert.equal(
    next,
    `name = "x" # a robot
[program]
duration = "2 s"

# how it bends
[[program.key]]
time = "3 s"

# and back

# where it is measured
[[marker]]           # the tip
name = "tip [a]"
`,
  );
  assert.equal(page.replaceEntries(next, 'program.key', '[[program.key]]\ntime = "3 s"'), next);
});

test('a file without a program gets one at its end, one with a list on a line loses that', () => {
  const key = '[[program.key]]\ntime = "3 s"';
  assert.equal(page.replaceEntries('a = 1\n\n[[marker]]\nname = "tip" # [\n', 'program.key', key), `a = 1\n\n[[marker]]\nname = "tip" # [\n\n${key}\n`);
  assert.equal(page.replaceEntries('[program]\nkey = [{ time = 1 },\n  { time = 2 }] # two\nsteps = 3\n', 'program.key', key), `[program]\nsteps = 3\n\n${key}\n`);
  assert.equal(page.replaceEntries('program.key = [] # none\na = "#[" # b\n', 'program.key', key), `a = "#[" # b\n\n${key}\n`);
});

test('what the keys of a program drive is known, however they are written', () => {
  const driven = (text) => [...page.drivenByKeys(text)].sort();
  assert.deepEqual(driven('[[program.key]]\ntime = "1 s"\nflexor = 0.9 # a = 1\n\n[[program.key]]\ntime = "2 s"\n"left.1" = 0.8\n[program]\nsteps = 3\n'), ['flexor', 'left.1']);
  assert.deepEqual(driven('[program]\nkey = [{ time = "1 s", flexor = 0.9 },\n  { time = "2 s", "air 1" = 1 }]\n'), ['air 1', 'flexor']);
  assert.deepEqual(driven('[program]\nsteps = 3\n[cable]\nflexor = 1\n'), []);
});

test('a program has seconds if the file has keys for it', () => {
  assert.equal(page.hasProgramKeys(withKeys), true);
  assert.equal(page.hasProgramKeys('[program]\nkey = [{ time = 1 }]\n'), true);
  assert.equal(page.hasProgramKeys('# [[program.key]]\n[program]\nsteps = 3 # key = 1\n[other]\nkey = 1\n'), false);
});

test('the rows that a table holds out itself are counted', () => {
  assert.equal(page.judgeRows('step,use,tip_x_mm\n1,fit,59\n2, judge ,58\r\n3,"judge",57\n'), 2);
  assert.equal(page.judgeRows('step;use;tip_x_mm\n1;judge;59\n'), 1);
  assert.equal(page.judgeRows('step,tip_x_mm\n1,59\n'), 0);
});

test('noise is no curve: an axis has a smallest range', () => {
  assert.deepEqual(page.axisRange(0, 4e-15), [-0.5, 0.5]);
  assert.deepEqual(page.axisRange(80, 80 + 1e-12), [79.5, 80.5]);
  assert.deepEqual(page.axisRange(0, 2), [0, 2]);
});

test('a print that was cancelled is known by its state', () => {
  const is = (flags, progress, canResume = false) => page.isCancelled({ state: { flags }, job: { canResume }, progress: { layer: 4, finished: false, failed: false, ...progress } });
  assert.equal(is({ operational: true, ready: true }, {}), true);
  assert.equal(is({ working: true }, {}), true);
  for (const flag of ['printing', 'paused', 'cancelling', 'error']) assert.equal(is({ [flag]: true }, {}), false, flag);
  for (const progress of [{ layer: null }, { finished: true }, { failed: true }]) assert.equal(is({}, progress), false);
  assert.equal(is({}, {}, true), false, 'it is interrupted');
});

test('an empty field says what is needed', () => {
  assert.equal(page.wrongText('', { from: 0, to: Infinity, open: true }, 'mm'), 'must be more than 0 mm');
  assert.equal(page.wrongText('-1', { from: 0, to: Infinity, open: true }, 'mm'), '-1: must be more than 0 mm');
});

test('a job is out of date by what its robot and its form say now, in the words of the form', () => {
  const source = { robot: 'abc', order: { printer: 'tower', copies: 1, layer: '100 um', resin: [] } };
  const order = { copies: 1, layer: '100 um', overlap: [] };
  assert.deepEqual(page.changesSince(source, 'abc', order), []);
  assert.deepEqual(page.changesSince(source, 'abc', null), []);
  assert.deepEqual(page.changesSince(source, 'def', order), ['robot']);
  assert.deepEqual(page.changesSince(source, 'abc', { ...order, layer: '50 um', printer: 'arm.toml' }), ['printer', 'layer height']);
  assert.deepEqual(page.changesSince(source, 'abc', { ...order, support: 'soft', lift: '2 mm', 'support-tip': '1 mm' }), ['supports']);
  assert.deepEqual(page.changesSince({ ...source, order: { layer_um: 100 } }, 'abc', order), []);
});

test('a form that nobody has filled in leaves the layer height to the printer', () => {
  const order = page.wholeOrder(['soft']);
  assert.deepEqual(order, { printer: 'tower', copies: 1, resin: [], exposure: [], overlap: [], interlock: [] });
  page.setOrder({ printer: 'arm.toml', layer: '80 um' });
  page.setOrder(order);
  assert.equal('layer' in page.wholeOrder(['soft']), false);
});

test('a form that takes the order of a job gives the same order again', () => {
  const order = {
    printer: 'arm.toml',
    copies: 3,
    layer: '50 um',
    'least-layer': '0.02 mm',
    spacing: '3 mm',
    support: 'soft',
    'support-angle': '30',
    'support-tip': '0.5 mm',
    turn: [90, 0, 0],
    scale: 2,
    at: [1, -2],
    'no-anti-alias': true,
    threshold: 0.4,
    'any-vat': true,
    resin: ['soft=semi-flex'],
    exposure: ['soft=2.5 s,8 s', 'hard=3 s'],
    overlap: ['soft+hard=3,1'],
    interlock: [],
    'support-paint': `${page.columns}\nblock,1,2,3,0,0,-1,2\n`,
  };
  page.setOrder(order);
  assert.deepEqual(page.wholeOrder(['soft', 'hard']), order);
  page.setOrder({ layer_um: 80 });
  assert.deepEqual(page.wholeOrder(['soft']), { printer: 'tower', copies: 1, layer: '80 um', resin: [], exposure: [], overlap: [], interlock: [] });
});

test('the colours of a field are those of the pictures, and are clamped at both ends', () => {
  assert.deepEqual(page.fieldColour(0), [0.267, 0.004, 0.329]);
  assert.deepEqual(page.fieldColour(1), [0.992, 0.906, 0.145]);
  assert.deepEqual(page.fieldColour(-3), page.fieldColour(0));
  assert.deepEqual(page.fieldColour(9), page.fieldColour(1));
  assert.deepEqual(page.fieldColour(NaN), page.fieldColour(0));
  page.fieldColour(0.25).forEach((v, i) => assert.ok(Math.abs(v - [0.2355, 0.29, 0.51][i]) < 1e-12));
  assert.match(page.gradientCss(), /^linear-gradient\(to top, rgb\(68 1 84\) 0%, .*100%\)$/);
});

test('an amount of resin that is not none is not shown as none', () => {
  assert.deepEqual([0, 0.004, 0.06, 12.34].map(page.millilitres), ['0.0 ml', 'under 0.1 ml', '0.1 ml', '12.3 ml']);
});

test('times, time steps and ranges are formatted', () => {
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

test('a straight recording keeps its end only; a corner is kept', () => {
  assert.deepEqual(program([0, 1, 2, 3, 4]), [[0.8, 4]]);
  assert.deepEqual(program([0, 1, 2, 2, 2]), [[0.4, 2], [0.8, 2]]);
  assert.deepEqual(program([1]), []);
});

test('a slowly curving recording keeps its path within 0.2 %', () => {
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

test('a recording has what was asked for, and readings without the noise of the solver', () => {
  const cable = { name: 'pull', type: 'cable', kind: 'shortening_mm', rest: 100, target: 5 };
  const written = (arrived, length_mm, asked) => {
    page.scene.value = { head: { actuators: [cable], markers: [], supports: [], obstacles: [] } };
    const wanted = { time: 0, actuators: asked === undefined ? [] : [{ name: 'pull', kind: 'shortening_mm', value: asked }] };
    page.frame.value = { head: { revision: 78, arrived, wanted, cables: [{ length_mm, ratio: length_mm / 100, tension_N: 0 }], chambers: [], markers: [] } };
    const value = page.writtenReading(cable, 'shortening_mm');
    page.frame.value = null;
    return value;
  };
  assert.equal(written(true, 97.00004, 3), 3);
  assert.equal(written(true, 100.000006, 0), 0);
  assert.equal(written(false, 100.000006, 3) + 0, 0);
  assert.equal(+written(true, 97.12344).toPrecision(5), 2.8766);
});

test('an exact curve goes on over a single approximate state, and has a gap where there are several', () => {
  const [e, r] = [false, true];
  const curve = (kinds) => page.exactCurve(kinds.map((_, i) => i), kinds.map((_, i) => 10 * i), kinds);
  assert.deepEqual(curve([e, r, e, r, e]), { x: [0, 2, 4], y: [0, 20, 40] });
  assert.deepEqual(curve([e, r, r, e]), { x: [0, 1, 2, 3], y: [0, NaN, NaN, 30] });
  assert.deepEqual(curve([r, e, r]), { x: [0, 1, 2], y: [NaN, 10, NaN] });
});

test('a text that was not applied comes back with its own robot only', () => {
  const finger = { name: 'finger.toml', title: 'finger.toml', opened: 1 };
  const fresh = { name: '', title: 'bar', opened: 2 };
  assert.ok(page.isSameRobot(finger, { ...finger, opened: 7 }, false), 'opened again');
  assert.ok(page.isSameRobot(finger, { ...finger, name: 'copy.toml' }, false), 'saved under another name');
  assert.ok(!page.isSameRobot(finger, { ...fresh, opened: 1 }, true), 'numbers of another studio mean nothing');
  assert.ok(!page.isSameRobot(fresh, { ...fresh, opened: 3 }, false));
  assert.ok(page.isSameRobot(fresh, { ...fresh, opened: 3 }, true), 'a studio that was started again');
  page.keep('a', finger);
  page.keep('b', finger);
  assert.equal(page.takeKept(fresh), null);
  assert.equal(page.takeKept({ ...finger, opened: 9 }), 'b');
  assert.deepEqual(page.keptTexts.value, []);
});

test('times of a program are seconds where it has them, else shares', () => {
  const words = (program, file) => {
    page.scene.value = { head: { actuators: [], markers: [], program } };
    page.theirs.value = file;
    return page.programTime(0.5, program.duration, 2);
  };
  assert.equal(words({ steps: 4, duration: 1 }, ''), '50 %');
  assert.equal(words({ steps: 4, duration: 2 }, ''), '0.50 s');
  assert.equal(words({ steps: 4, duration: 1, timed: true }, ''), '0.50 s');
  assert.equal(words({ steps: 4, duration: 1 }, '[[program.key]]\ntime = "1 s"\n'), '0.50 s');
  page.theirs.value = '';
});

test('what is rounded to 0 has no sign', () => {
  assert.deepEqual([-0.001, -0, 0.001, -0.005001, -10].map((v) => page.fixed(v, 2)), ['0.00', '0.00', '0.00', '-0.01', '-10.00']);
  assert.equal(page.fixed(-0.3, 0), '0');
});

test('an hour of recording beside a robot that stands still is read at once', () => {
  const began = process.cpuUsage();
  assert.deepEqual(program(Array.from({ length: 18_000 }, (_, i) => (i === 9000 ? 5 : 2))), [[1799.8, 2], [1800, 5], [1800.2, 2], [3599.8, 2]]);
  const took_s = 1e-6 * process.cpuUsage(began).user;
  assert.ok(took_s < 5, `${took_s} s`); // checked key by key: over half a minute
});

test('a recorded program ends with its last key', () => {
  page.scene.value = { head: { actuators: [actuators[0]], markers: [] } };
  page.recorded.value = [0, 1, 2].map((value, i) => ({ time: 0.2 * i, values: { flexor: { kind: 'tension_N', value } } }));
  assert.deepEqual(page.endOf(page.asProgram()), [{ key: 'program.duration', value: '0.40 s' }]);
  assert.deepEqual(page.endOf(''), []);
});

test('values driven by another quantity earlier do not become keys', () => {
  page.scene.value = { head: { actuators, markers: [] } };
  const key = (time, kind, value) => ({ time, values: { flexor: { kind, value }, 'air "1"': { kind: 'volume_ratio', value: 1.5 } } });
  page.recorded.value = [key(0, 'length_ratio', 1), key(0.2, 'tension_N', 3), key(0.4, 'tension_N', 4.000001)];
  assert.equal(page.asProgram(), '[[program.key]]\ntime = "0.20 s"\nflexor = "3 N"\n"air \\"1\\"" = 1.5\n\n[[program.key]]\ntime = "0.40 s"\nflexor = "4 N"\n"air \\"1\\"" = 1.5');
});

test('the plots\' data as a table: quoted names, linear states marked, no time column in statics', () => {
  const marker = { name: 'tip', rest: [0, 0, 0] };
  page.scene.value = { head: { order: 2, actuators, markers: [marker], supports: ['clamp'], obstacles: [] } };
  const frame = (sequence, x, order) => ({ head: { revision: 77, sequence, order, time: 0, energy_mJ: 1, cables: [{ tension_N: x, ratio: 1, length_mm: 80 }], chambers: [{ pressure_kPa: 2 * x, ratio: 1, volume_mm3: 5 }], markers: [[x, 4, 0]], supports: [[0, 3, 4]], residual: 0 } });
  page.frame.value = frame(1, 3, 1);
  page.frame.value = frame(1, 3, 1); // the same state again
  const pause = performance.now() + 300;
  while (performance.now() < pause);
  page.frame.value = frame(2, 4, 2);
  const [head, ...rows] = page.tracksCsv().trimEnd().split('\r\n').map((r) => r.split(','));
  assert.equal(head.join(), 'seconds,elements,flexor_tension_N,flexor_shortening_mm,flexor_length_ratio,"air ""1""_pressure_kPa","air ""1""_volume_change_mm3","air ""1""_volume_ratio",tip_displacement_mm,tip_x_mm,tip_y_mm,tip_z_mm,clamp_force_N,energy_mJ,time,residual');
  assert.equal(rows.length, 2);
  const cell = (row, name) => Number(row[head.indexOf(name)]);
  assert.deepEqual(rows.map((r) => cell(r, 'elements')), [1, 2]);
  assert.deepEqual(rows.map((r) => cell(r, 'flexor_tension_N')), [3, 4]);
  assert.deepEqual(rows.map((r) => cell(r, 'tip_displacement_mm')), [5, Math.hypot(4, 4)]);
  assert.equal(cell(rows[0], 'clamp_force_N'), 5);
  assert.equal(cell(rows[1], 'seconds'), 0.1);
  page.keepRun('first');
  assert.deepEqual(page.runs.value[0].columns.flexor_tension_N, [4], 'of a kept run the linear states are left out');
  assert.equal(page.runs.value[0].name, 'first 1');
  page.runs.value = [];
  page.frame.value = { head: { ...frame(1, 5, 1).head, revision: 78 } }; // another robot begins anew
  assert.deepEqual(page.valuesOf('tip_x_mm'), [5]);
  page.keepRun('run');
  assert.deepEqual([page.runs.value[0].name, page.runs.value[0].columns.flexor_tension_N], ['≈ run 1', [5]], 'a robot that has only linear states keeps them, and its run says so');
  assert.equal(page.freeTableName('m.csv'), 'm.csv');
  page.runs.value = [{ name: 'm.csv', columns: {} }];
  assert.equal(page.freeTableName('m.csv'), 'm.csv (2)');
  page.runs.value = [];
});

test('a table of measurements is read, or refused with its line', () => {
  const read = page.readTable('m.csv', '"tip, x",flexor_tension_N\r\n1,2\r\n\r\n3,\r\n');
  assert.deepEqual(read.columns['tip, x'], [1, 3]);
  assert.equal(read.columns.flexor_tension_N[0], 2);
  assert.ok(Number.isNaN(read.columns.flexor_tension_N[1]));
  assert.deepEqual(page.readTable('m.csv', 'a;b\n1;2\n').columns, { a: [1], b: [2] });
  assert.match(page.readTable('m.csv', ''), /^m\.csv:1: a header line/);
  assert.match(page.readTable('m.csv', '1,2\n3,4\n'), /^m\.csv:1: the first line must name/);
  assert.match(page.readTable('m.csv', 'a,b\n1,2\n3\n'), /^m\.csv:3: 1 columns, but the header line names 2/);
  assert.match(page.readTable('m.csv', 'a,b\n1,two\n'), /^m\.csv:2: "two" is not a number/);
  assert.match(page.readTable('m.csv', 'a,b\n'), /no rows/);
  assert.equal(page.readTable('m.csv', '# x\ntime,a,a\n0,1,2\n'), 'm.csv:2: two columns are named a; every column needs a name of its own');
  assert.deepEqual(page.readTable('m.csv', '# measured\na,b\n# x\n1,2\n').columns, { a: [1], b: [2] });
  assert.match(page.readTable('m.csv', '# measured\na,b\n\n# x\n1\n'), /^m\.csv:5: 1 columns/);
  assert.equal(page.judgeRows('# x\nuse,b\n#judge,1\njudge,2\n'), 1);
});

test('a stop is reported by its cause: requested, by the firmware, or none', () => {
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

test('arrow keys turn a view; other keys are left to the page', () => {
  const turns = [];
  let home = 0;
  let kept = 0;
  const press = (key) => page.orbitKeys({ key, preventDefault: () => ++kept }, (...t) => turns.push(t), () => ++home);
  for (const key of ['ArrowLeft', 'ArrowUp', '+', 'Home', 'a', 'Tab']) press(key);
  assert.deepEqual(turns, [[-0.12, 0, 1], [0, 0.12, 1], [0, 0, 0.9]]);
  assert.equal(home, 1);
  assert.equal(kept, 4);
});

test('a fitted camera sees every point, and one slightly nearer does not, for any shape', () => {
  let seed = 1;
  const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647 - 0.5;
  const dot = (p, q) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
  for (const size of [[100, 1, 1], [1, 1, 100], [3, 80, 2], [50, 50, 50], [1e-3, 2e-3, 1e-3]]) {
    const points = Array.from({ length: 60 }, (_, i) => random() * size[i % 3] + 7);
    const c = Math.SQRT1_2;
    const [right, up, forward] = [[c, c, 0], [0, 0, 1], [-c, c, 0]];
    const [tx, ty] = [0.4, 0.25];
    const fit = page.fitPoints(points, right, up, forward, tx, ty);
    const worst = (camera) => {
      let most = 0;
      for (let i = 0; i < points.length; i += 3) {
        const p = [0, 1, 2].map((k) => points[i + k] - camera[k]);
        const depth = dot(p, forward);
        most = Math.max(most, depth <= 0 ? Infinity : Math.max(Math.abs(dot(p, right)) / (tx * depth), Math.abs(dot(p, up)) / (ty * depth)));
      }
      return most;
    };
    assert.ok(worst(fit.camera) < 1 + 1e-9, `${size}: ${worst(fit.camera)}`);
    const nearer = fit.camera.map((v, k) => v + 0.02 * (fit.target[k] - v));
    assert.ok(worst(nearer) > 1, `${size}: it could be nearer`);
  }
});

test('a scale bar is 1, 2 or 5 times a power of ten', () => {
  assert.deepEqual([137, 50, 49.9, 20, 19, 10, 9.99, 0.7, 0.013].map((v) => +page.niceBelow(v).toPrecision(12)), [100, 50, 20, 20, 10, 10, 5, 0.5, 0.01]);
});

test('colour maps reach both ends, may have bands, and treat NaN as the lower end', () => {
  for (const map of Object.keys(page.maps)) {
    const at = (t, bands) => page.fieldColour(t, map, bands);
    assert.deepEqual(at(0), [...page.maps[map].stops[0]]);
    assert.deepEqual(at(2), [...page.maps[map].stops.at(-1)]);
    assert.deepEqual(at(NaN), at(0));
    assert.deepEqual(at(0.01, 5), at(0.19, 5));
    assert.notDeepEqual(at(0.19, 5), at(0.21, 5));
    assert.deepEqual(at(1, 5), at(0.9, 5));
  }
  assert.deepEqual(page.fieldColour(0.3, 'no such map'), page.fieldColour(0.3));
});

test('a face can be laid on the platform from any rotation; angles are those of the slicer', () => {
  // The normals of a tilted roof, through every kind of turn.
  for (const turn of [[0, 0, 0], [90, 0, 0], [30, -40, 70], [0, 90, 0], [180, 0, 45]]) {
    const rotation = page.rotationOf(turn);
    const again = page.rotationOf(page.degreesOf(rotation));
    rotation.elements.forEach((v, k) => assert.ok(Math.abs(v - again.elements[k]) < 1e-4, `${turn}: ${v} is not ${again.elements[k]}`));
    const drawn = { x: 0.6, y: -0.48, z: 0.64 }; // of length 1, in the part's own axes
    const now = page.turned(turn, drawn);
    const after = page.turned(page.layOnFace(turn, now), drawn);
    assert.ok(Math.hypot(after.x, after.y, after.z + 1) < 1e-4, `${turn}: the face looks to ${after.x}, ${after.y}, ${after.z}`);
  }
  // About x first, then y, then z: as `pliant slice --turn 90 90 0`.
  const z = page.turned([90, 90, 0], { x: 0, y: 1, z: 0 });
  assert.ok(Math.hypot(z.x - 1, z.y, z.z) < 1e-9, `${z.x}, ${z.y}, ${z.z}`);
});

test('copies are arranged in rows within the image, and too many do not fit', () => {
  const bar = new Float32Array([0, 0, 0, 40, 10, 5]);
  const room = { image: [100, 60], offset: [0, 0], turn: 0, platform: [200, 200] };
  const one = page.placed(bar, [0, 0, 0], 1, 2, room, 50);
  assert.deepEqual(one.size, [40, 10, 5]);
  const five = page.placed(bar, [0, 0, 0], 5, 2, room, 50);
  assert.deepEqual(five.size, [82, 34, 5]); // two in a row, three rows
  assert.deepEqual(five.shifts.at(-1), [0, 24]);
  assert.ok(five.fits);
  assert.ok(!page.placed(bar, [0, 0, 0], 11, 2, room, 50).fits, 'six rows are too deep');
  assert.ok(!page.placed(bar, [0, 90, 0], 1, 2, room, 30).fits, 'upright it is too high');
  assert.ok(page.placed(bar, [0, 90, 0], 1, 2, room, 40).fits);
});

test('copies stand within an image that is turned, or off the middle of the platform', () => {
  const cube = new Float32Array([0, 0, 0, 1, 1, 1]);
  const fits = (copies, room) => page.placed(cube, [0, 0, 0], copies, 0, { image: [6.4, 4.8], offset: [0, 0], turn: 0, platform: [200, 200], ...room }, 50).fits;
  assert.ok(fits(24, {}) && !fits(25, {}));
  assert.ok(fits(24, { turn: 90 }) && !fits(25, { turn: 90 }));
  assert.ok(fits(9, { turn: 45 }) && !fits(10, { turn: 45 }), 'three by three stand across the corners');
  assert.ok(fits(12, { offset: [-1.2, 0.5] }) && !fits(13, { offset: [-1.2, 0.5] }));
  assert.deepEqual(page.area({ image: [6.4, 4.8], offset: [0, 0], turn: 90, platform: [200, 200] }), [4.8, 6.4]);
});

test('the tab\'s title shows a print\'s progress, or a question mark if it is unknown', () => {
  const is = { machine: true, known: true, busy: true, paused: false, error: false, finished: false, completion: 43.9, job: 'finger' };
  assert.equal(page.tellingOf({ ...is, machine: false }, 'Pliant').title, 'Pliant');
  assert.equal(page.tellingOf(is, 'Pliant').title, '43 % finger · Pliant');
  assert.equal(page.tellingOf({ ...is, paused: true }, 'Pliant').title, 'Paused, 43 % finger · Pliant');
  assert.deepEqual([page.tellingOf({ ...is, known: false }, 'Pliant').title, page.tellingOf({ ...is, known: false }, 'Pliant').share], ['? finger · Pliant', null]);
  assert.equal(page.tellingOf({ ...is, error: true, busy: false }, 'Pliant').title, 'Stopped: finger · Pliant');
  assert.equal(page.tellingOf({ ...is, busy: false, finished: true }, 'Pliant').title, 'Printed: finger · Pliant');
  assert.equal(page.tellingOf({ ...is, busy: false }, 'Pliant').title, 'Pliant');
});

test('every key that the reference names in its tables can be completed', () => {
  const reference = readFileSync(new URL('../../docs/reference/robot.md', import.meta.url), 'utf8');
  let table = null;
  let checked = 0;
  for (const line of reference.split('\n')) {
    const heading = /^##+ (.*)/.exec(line)?.[1];
    if (heading !== undefined) table = heading === 'Top level' ? '' : (/^\[+([a-z_.A-Z]+)\]+$/.exec(heading)?.[1].replace('.NAME', '') ?? null);
    const cell = table === null ? null : /^\| `([a-z_][a-z_0-9.]*)` \|/.exec(line);
    if (!cell || (table === 'body' && ['from', 'shares', 'cell'].includes(cell[1]))) continue; // those are of its blend
    assert.ok(page.robotKeys[table]?.[cell[1]], `[${table}] ${cell[1]}`);
    checked += 1;
  }
  assert.ok(checked > 60, `${checked}`);
});

test('the table at the end of a text, and the parameters of formulas, are found', () => {
  assert.equal(page.tableAt('name = "x"\n'), '');
  assert.equal(page.tableAt('[material.soft]\na = 1\n'), 'material');
  assert.equal(page.tableAt('[a]\n[[cable]]\npoints = [[0, 0, 0],\n[1, 1, 1]]\n'), 'cable');
  assert.equal(page.tableAt('[[program.key]]\n'), 'program.key');
  assert.deepEqual(page.parametersOf('x = 1\n[parameters] # p\nnotches = 4 # n\nlong-name=1_000.5e-1\nf = "= 80 / notches"\n[mesh]\nsize = 3\n'), [{ name: 'notches', value: 4 }, { name: 'long-name', value: 100.05 }]);
});

/// The pictures of a GIF, as indices into its table and as colours: LZW the other way round.
function readGif(bytes) {
  const text = (at, n) => String.fromCharCode(...bytes.slice(at, at + n));
  assert.equal(text(0, 6), 'GIF89a');
  const width = bytes[6] | (bytes[7] << 8);
  const height = bytes[8] | (bytes[9] << 8);
  const table = bytes.slice(13, 13 + 768);
  const frames = [];
  const shown = new Array(width * height).fill(null);
  let at = 13 + 768;
  let [delay, none] = [0, -1];
  while (bytes[at] !== 0x3b) {
    if (bytes[at] === 0x21) {
      if (bytes[at + 1] === 0xf9) [delay, none] = [bytes[at + 4] | (bytes[at + 5] << 8), bytes[at + 3] & 1 ? bytes[at + 6] : -1];
      at += 2;
      while (bytes[at] !== 0) at += bytes[at] + 1;
      at += 1;
      continue;
    }
    assert.equal(bytes[at], 0x2c);
    at += 10;
    const least = bytes[at++];
    const data = [];
    while (bytes[at] !== 0) {
      data.push(...bytes.slice(at + 1, at + 1 + bytes[at]));
      at += bytes[at] + 1;
    }
    at += 1;
    const [clear, end] = [1 << least, (1 << least) + 1];
    let [words, size, bit, before] = [[], least + 1, 0, null];
    const reset = () => ((words = Array.from({ length: end + 1 }, (_, k) => [k])), (size = least + 1), (before = null));
    const next = () => {
      let code = 0;
      for (let k = 0; k < size; ++k, ++bit) code |= ((data[bit >> 3] >> (bit & 7)) & 1) << k;
      return code;
    };
    reset();
    const pixels = [];
    for (let code = next(); code !== end; code = next()) {
      if (code === clear) {
        reset();
        continue;
      }
      assert.ok(code < words.length || (code === words.length && before), 'a word that is not known yet');
      const word = words[code] ?? [...before, before[0]];
      pixels.push(...word);
      if (before && words.length < 4096) words.push([...before, word[0]]);
      if (words.length === 1 << size && size < 12) size += 1;
      before = word;
    }
    assert.equal(pixels.length, width * height);
    pixels.forEach((p, k) => p !== none && (shown[k] = [...table.slice(3 * p, 3 * p + 3)]));
    frames.push({ delay, colours: shown.slice() });
  }
  return { width, height, frames };
}

test('a GIF holds its pictures in nearly their colours, also when its code table is full', () => {
  const [w, h] = [160, 120];
  let seed = 7;
  const random = () => (seed = (seed * 1103515245 + 12345) % 2147483648) / 2147483648;
  const picture = (k) => {
    const data = new Uint8ClampedArray(4 * w * h);
    for (let i = 0; i < w * h; ++i) {
      const [x, y] = [i % w, Math.floor(i / w)];
      const noisy = x > 80; // no word comes twice there, so that the table of words fills up
      data.set([noisy ? 255 * random() : x + 10 * k, noisy ? 255 * random() : 2 * y, noisy ? 255 * random() : 40, 255], 4 * i);
    }
    return { data };
  };
  const pictures = [picture(0), picture(1), picture(1)];
  pictures.push(pictures[2]);
  const read = readGif(page.animatedGif(pictures, w, h, 40, 1200));
  assert.deepEqual([read.width, read.height, read.frames.length], [w, h, 4]);
  assert.deepEqual(read.frames.map((f) => f.delay), [4, 4, 4, 120]);
  read.frames.forEach((f, k) => {
    let worst = 0;
    for (let i = 0; i < w * h; ++i) {
      if (i % w > 80) continue;
      for (let c = 0; c < 3; ++c) worst = Math.max(worst, Math.abs(f.colours[i][c] - pictures[k].data[4 * i + c]));
    }
    assert.ok(worst < 48, `picture ${k}: ${worst} of 255`);
  });
  const plain = new Uint8ClampedArray(4 * 4).fill(200);
  const one = readGif(page.animatedGif([{ data: plain }], 2, 2, 40, 40));
  assert.deepEqual(one.frames[0].colours, Array(4).fill([200, 200, 200]));
});

test('a sweep has even values, round ticks, and a table column for each result', () => {
  assert.deepEqual(page.evenly(1, 2, 3), [1, 1.5, 2]);
  assert.deepEqual(page.evenly(0.1, 0.3, 3), [0.1, 0.2, 0.3]);
  assert.deepEqual(page.evenly(5, 9, 1), [5]);
  assert.deepEqual(page.ticks(0, 1), [0, 0.2, 0.4, 0.6, 0.8, 1]);
  assert.deepEqual(page.ticks(-3.2, 11), [0, 5, 10]);
  assert.deepEqual(page.extent([2, NaN, 3]), [2, 3]);
  const [low, high] = page.extent([4, 4]);
  assert.ok(low < 4 && high > 4);
  assert.deepEqual(page.quantity('12 MPa'), { value: 12, unit: 'MPa' });
  assert.deepEqual(page.quantity('0.45'), { value: 0.45, unit: '' });
  assert.equal(page.quantity('soft'), null);
  const found = {
    axes: [{ key: 'material.soft.youngs_modulus', unit: 'MPa', values: [1, 2] }],
    columns: [{ key: 'flexor_tension_N', label: 'flexor: tension', unit: 'N' }, { key: 'my tip_x_mm', label: 'my tip: x', unit: 'mm' }],
    runs: [{ inputs: [1], results: [3, 4], why: '' }, { inputs: [2], results: [], why: 'folded' }],
  };
  assert.deepEqual(page.columnOf(found, 1), [4, NaN]);
  assert.equal(page.sweepCsv(found), 'material.soft.youngs_modulus_MPa,flexor_tension_N,"my tip_x_mm"\r\n1,3,4\r\n2,,\r\n');
  const warned = { ...found, runs: [{ ...found.runs[0], warning: 'below a "vacuum"' }, found.runs[1]] };
  assert.equal(page.sweepCsv(warned, true), 'material.soft.youngs_modulus_MPa,flexor_tension_N,"my tip_x_mm",elements,warning\r\n1,3,4,1,"below a ""vacuum"""\r\n2,,,1,\r\n');
});

test('a geometry file becomes a robot: with its unit and bodies, fixed at one end of its longest side', () => {
  const surface = { name: 'my finger.stl', kind: 'surface', unit_mm: 0, low: [0, 0, 0], high: [60, 12, 10], text: '', parts: [], notes: [] };
  assert.equal(page.usualSide(surface), '-x');
  const text = page.robotOf(surface, 'mm', 'dragon-skin-30', '-x');
  assert.match(text, /^name = "my finger"\nlength_unit = "mm"\n/);
  assert.match(text, /\[\[body\]\]\nname = "my finger"\nmaterial = "dragon-skin-30"\ngeometry = "my finger.stl"\n/);
  assert.match(text, /\[\[fixed\]\]\nname = "base"\nbox = \[\[-1.2, -1.2, -1.2\], \[1.2, 13.2, 11.2\]\]/);
  assert.match(text, /size = "5 mm"/);
  assert.match(page.robotOf(surface, 'mm', 'x', 'z'), /box = \[\[-1.2, -1.2, 8.8\], \[61.2, 13.2, 11.2\]\]/);
  // A thin sheet is not held at its other side as well.
  assert.match(page.robotOf({ ...surface, high: [100, 60, 1.5] }, 'mm', 'x', '-z'), /box = \[\[-2, -2, -0.375\], \[102, 62, 0.375\]\]/);
  assert.match(page.robotOf({ ...surface, low: [0, 0, 1e4], high: [100, 60, 10000.2] }, 'mm', 'x', '-z'), /box = \[\[-2, -2, 9999.95\], \[102, 62, 10000.05\]\]/);
  // A file that says millimetres, in a robot of centimetres.
  const step = { ...surface, name: 'a.step', kind: 'step', unit_mm: 1 };
  assert.match(page.robotOf(step, 'cm', 'x', '-x'), /box = \[\[-0.12, -0.12, -0.12\], \[0.12, 1.32, 1.12\]\]/);
  const plate = { ...surface, name: 'two.3mf', kind: '3mf', unit_mm: 1, parts: ['soft', 'stiff'] };
  assert.deepEqual(page.bodiesOf(plate, 'two.3mf', 'm', ['soft']), [
    { name: 'soft 1', material: 'm', geometry: 'two.3mf', part: 'soft' },
    { name: 'stiff', material: 'm', geometry: 'two.3mf', part: 'stiff' },
  ]);
  const tets = { ...surface, name: 'a.vtk', kind: 'tets', parts: ['body'] };
  assert.match(page.robotOf(tets, 'mm', 'm', '-x'), /region = "body"\n\n\[mesh\]\nfile = "a.vtk"\n/);
  assert.deepEqual(page.bodiesOf(surface, '../x.stl', 'm', [], 25.4)[0].place, { scale: 25.4 });
});

test('a motion shows the last state up to its time; a workspace states its number of samples', () => {
  const times = [0, 0.1, 0.2, 0.4];
  assert.deepEqual([0, 0.05, 0.1, 0.39, 0.4, 9].map((t) => page.indexAt(times, t)), [0, 0, 1, 2, 3, 3]);
  assert.deepEqual([page.samplesOf(1, 9, 50), page.samplesOf(2, 9, 50), page.samplesOf(3, 5, 10), page.samplesOf(6, 9, 50)], [9, 131, 160, 50]);
});
