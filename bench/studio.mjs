// Frame rate and latency of the studio: a hand that drags the cable of the gripper of some 7,500 linear tets to and fro,
// sixty inputs a second, in Chromium on the real program.
//   node bench/studio.mjs [SECONDS]        after a release build; needs chromium
import { cpus, loadavg } from 'node:os';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const root = new URL('..', import.meta.url).pathname;
process.env.PLIANT_WEB ??= join(root, 'build/release/web');
process.env.PLIANT_PROGRAM ??= join(root, 'build/release/apps/pliant/pliant');
const { openPage, settled, startBrowser, startStudio } = await import('../web/test/studio.mjs');

const seconds = Number(process.argv[2] ?? 8);
const folder = mkdtempSync(join(tmpdir(), 'pliant_bench_'));
const gripper = readFileSync(join(root, 'examples/cable_gripper/gripper.toml'), 'utf8');
writeFileSync(join(folder, 'gripper.toml'), gripper.replace('size = "3 mm"', 'size = "2.8 mm"'));

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

const studio = await startStudio(['gripper.toml'], folder);
const browser = await startBrowser();
try {
  console.log(`${cpus().length} cores, load ${loadavg()[0].toFixed(1)} before; ${cpus()[0].model}`);
  const { page } = await openPage(browser, studio.address);
  await settled(page);
  const tets = await page.evaluate(() => window.pliant.scene.value.head.tets);
  console.log(`${tets} linear tets, tolerance 1e-4, ${seconds} s each`);
  console.log('| measured | frames per second | frames at target | solver, ms | latency, median, ms | latency, 95 %, ms | longest gap, 95 %, ms |');
  console.log('|---|---|---|---|---|---|---|');
  for (const [what, section] of [['received, not drawn', 'print'], ['drawn in software', 'simulate']]) {
    await page.evaluate((s) => (window.pliant.section.value = s), section);
    await page.waitForTimeout(500);
    await drag(page, 1);
    const r = await drag(page, seconds);
    console.log(
      `| ${what} | ${r.fps.toFixed(1)} | ${(100 * r.arrived).toFixed(0)} % | ${r.solve.toFixed(1)} | ${r.latency[0].toFixed(0)} | ${r.latency[1].toFixed(0)} | ${r.gap.toFixed(0)} |`,
    );
  }
} finally {
  await browser.close();
  await studio.stop();
  rmSync(folder, { recursive: true, force: true });
}
