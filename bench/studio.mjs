// What the studio makes its user wait for. First picture: from opening the address to a robot in the 3D view. Stack: from a
// click to thirty layers of a job in 3D. Frame rate and latency: a hand that drags the cable of the gripper of some 7,500
// tets to and fro, sixty inputs a second, in Chromium on the real program. Linear tets as such; quadratic ones by the
// linear preview and, once it has been made, by the reduced model.
//   node bench/studio.mjs [SECONDS]        after a release build; needs chromium
import { cpus, loadavg } from 'node:os';
import { copyFileSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const root = new URL('..', import.meta.url).pathname;
process.env.PLIANT_WEB ??= join(root, 'build/release/web');
process.env.PLIANT_PROGRAM ??= join(root, 'build/release/apps/pliant/pliant');
const { openPage, settled, startBrowser, startStudio } = await import('../web/test/studio.mjs');

const seconds = Number(process.argv[2] ?? 8);
const folder = mkdtempSync(join(tmpdir(), 'pliant_bench_'));
const gripper = readFileSync(join(root, 'examples/cable_gripper/gripper.toml'), 'utf8');

/// Drags for so long; what came of it.
function drag(page, duration) {
  return page.evaluate(async (duration) => {
    const { pliant } = window;
    const latencies = [];
    const solves = [];
    const gaps = [];
    let frames = 0;
    let arrived = 0;
    let last = performance.now();
    const stop = pliant.frame.subscribe((f) => {
      if (!f) return;
      const now = performance.now();
      frames += 1;
      arrived += f.head.arrived ? 1 : 0;
      latencies.push(pliant.latency.value);
      solves.push(f.head.solve_ms);
      gaps.push(now - last);
      last = now;
    });
    const start = performance.now();
    await new Promise((resolve) => {
      const timer = setInterval(() => {
        const t = (performance.now() - start) / 1000;
        if (t > duration) {
          clearInterval(timer);
          resolve();
          return;
        }
        const value = 0.85 + 0.13 * Math.cos(2 * Math.PI * 0.25 * t);
        pliant.sendInput({ type: 'drive', actuators: [{ name: 'flexor', kind: 'length_ratio', value }] });
      }, 1000 / 60);
    });
    stop();
    const sorted = (list) => list.slice().sort((a, b) => a - b);
    const at = (list, share) => sorted(list)[Math.floor(share * (list.length - 1))];
    return {
      fps: frames / duration,
      arrived: arrived / frames,
      solve: at(solves, 0.5),
      latency: [at(latencies, 0.5), at(latencies, 0.95)],
      gap: at(gaps, 0.95),
    };
  }, duration);
}

async function measure(page, tets) {
  for (const [what, section] of [['received, not drawn', 'print'], ['drawn in software', 'simulate']]) {
    await page.evaluate((s) => (window.pliant.section.value = s), section);
    await page.waitForTimeout(500);
    await drag(page, 1);
    const r = await drag(page, seconds);
    console.log(
      `| ${tets} | ${what} | ${r.fps.toFixed(1)} | ${(100 * r.arrived).toFixed(0)} % | ${r.solve.toFixed(1)} | ${r.latency[0].toFixed(0)} | ${r.latency[1].toFixed(0)} | ${r.gap.toFixed(0)} |`,
    );
  }
}

/// Moves the cable a little until the frames are those of the reduced model; false after two minutes.
async function reduced(page) {
  for (let k = 0; k < 1200; ++k) {
    await page.evaluate((value) => window.pliant.sendInput({ type: 'drive', actuators: [{ name: 'flexor', kind: 'length_ratio', value }] }), 0.95 - 0.001 * (k % 9));
    await page.waitForTimeout(100);
    if (await page.evaluate(() => window.pliant.frame.value.head.reduced_error_mm !== undefined)) return true;
  }
  return false;
}

/// Seconds from the navigation to the address to the first picture of the robot, which the server draws, and to the first
/// one of the 3D view.
async function firstPictures(studio) {
  const { page, context } = await openPage(browser, studio.address);
  await page.waitForFunction(() => window.pliant?.frame?.value && !document.querySelector('.first-picture'));
  const took = await page.evaluate(async () => {
    const live = await new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(() => drawn(performance.now()))));
    const entries = await new Promise((found) => new PerformanceObserver((list) => found(list.getEntries())).observe({ type: 'element', buffered: true }));
    return [entries[0].renderTime / 1000, live / 1000];
  });
  await context.close();
  return took;
}

/// Seconds from the click to the job in 3D.
async function stack(studio) {
  const { page, context } = await openPage(browser, `${studio.address}#make`);
  await page.getByTestId('estimate').waitFor();
  await page.getByTestId('option-layer').fill('400');
  await page.getByTestId('slice').click();
  await page.getByTestId('layer-view').waitFor();
  const begin = performance.now();
  await page.getByTestId('make-stack').click();
  await page.waitForSelector('[data-testid=stack-view][data-state=shown]');
  const took = (performance.now() - begin) / 1000;
  await context.close();
  return took;
}

async function waits() {
  copyFileSync(join(root, 'examples/tutorial/finger.toml'), join(folder, 'finger.toml'));
  const pictures = [];
  for (let k = 0; k < 5; ++k) {
    const studio = await startStudio(['finger.toml'], folder);
    try {
      pictures.push(await firstPictures(studio));
    } finally {
      await studio.stop();
    }
  }
  const list = (which) => pictures.map((two) => two[which].toFixed(2)).join(', ');
  console.log(`first picture, as the server draws it: ${list(0)} s; in 3D: ${list(1)} s after the address was opened`);
  const studio = await startStudio(['finger.toml'], folder);
  try {
    console.log(`stack of 30 layers: ${(await stack(studio)).toFixed(2)} s`);
  } finally {
    await studio.stop();
  }
}

const browser = await startBrowser();
console.log(`${cpus().length} cores, load ${loadavg()[0].toFixed(1)} before; ${cpus()[0].model}`);
await waits();
console.log(`tolerance 1e-4, ${seconds} s each`);
console.log('| tets | measured | frames per second | frames at target | solver, ms | latency, median, ms | latency, 95 %, ms | longest gap, 95 %, ms |');
console.log('|---|---|---|---|---|---|---|---|');
for (const order of [1, 2]) {
  const text = gripper.replace('size = "3 mm"', `size = "2.8 mm"\norder = ${order}`);
  writeFileSync(join(folder, 'gripper.toml'), text);
  const studio = await startStudio(['gripper.toml'], folder);
  try {
    const { page } = await openPage(browser, studio.address);
    await settled(page);
    const count = (await page.evaluate(() => window.pliant.scene.value.head.tets)).toLocaleString('en');
    await measure(page, order === 1 ? `${count} linear` : `${count} quadratic, linear preview`);
    if (order === 2 && (await reduced(page))) await measure(page, `${count} quadratic, reduced model`);
    await page.close();
  } finally {
    await studio.stop();
  }
}
await browser.close();
rmSync(folder, { recursive: true, force: true });
