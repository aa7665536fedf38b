// Preparing and printing as a newcomer sees them: the part on the platform, the job in 3D, and a print that is watched
// from another tab, from another room, and by a camera.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { copyFileSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { openPage, program, settled, startBrowser, startPrint, startStudio, takeTwin } from './studio.mjs';

const example = (name) => new URL(`../../examples/${name}`, import.meta.url).pathname;
let folder;
let browser;
let studio;
let camera;
let pictures = 0;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'pliant_front_'));
  copyFileSync(example('tutorial/finger.toml'), join(folder, 'finger.toml'));
  // A camera that answers with a picture: the smallest that a browser shows.
  const png = Buffer.from('iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==', 'base64');
  camera = createServer((_, answer) => {
    ++pictures;
    answer.writeHead(200, { 'Content-Type': 'image/png', 'Cross-Origin-Resource-Policy': 'cross-origin' });
    answer.end(png);
  });
  await new Promise((listening) => camera.listen(0, '127.0.0.1', listening));
  const webcam = `http://127.0.0.1:${camera.address().port}/snap.png`;
  const notify = `echo "$PLIANT_EVENT: $PLIANT_TEXT" >> ${join(folder, 'heard')}`;
  studio = await startStudio(['finger.toml', '--webcam', webcam, '--notify', notify], folder);
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
  await studio?.stop();
  camera?.close();
  rmSync(folder, { recursive: true, force: true });
});

const text = (page, id) => page.getByTestId(id).textContent();

/// Pixels of a view that are not its background: more where more of the part is seen.
async function drawn(page, id) {
  const png = (await page.getByTestId(id).screenshot()).toString('base64');
  return page.evaluate(async (data) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const g = Object.assign(document.createElement('canvas'), { width: image.width, height: image.height }).getContext('2d');
    g.drawImage(image, 0, 0);
    const pixels = g.getImageData(0, 0, image.width, image.height).data;
    let n = 0;
    for (let i = 0; i < pixels.length; i += 4) if (Math.max(...pixels.slice(i, i + 3)) - Math.min(...pixels.slice(i, i + 3)) > 60) ++n;
    return n;
  }, png);
}

test('before slicing, the robot is shown on the platform: rotated, laid on a face, copied, with an estimate at once', async (t) => {
  const { page, wrong } = await openPage(browser, studio.address, t);
  await settled(page);
  await page.getByTestId('section-make').click();
  await page.getByTestId('option-layer').fill('1000');
  await page.waitForFunction(() => /· 12 layers · 12 swaps/.test(document.querySelector('[data-testid=estimate]')?.textContent ?? ''));
  const lying = await drawn(page, 'bed-view');
  assert.ok(lying > 5000, `${lying} pixels of the part`);
  // Upright it is 80 mm high: more layers, and it still fits.
  await page.getByTestId('turn-y').click();
  await page.waitForFunction(() => /· 80 layers/.test(document.querySelector('[data-testid=estimate]')?.textContent ?? ''));
  assert.equal(await page.getByTestId('bed').getAttribute('data-fits'), 'true');
  // The face that is clicked goes down: the middle of the picture is one of the long sides, and it lies again.
  await page.getByTestId('lay-on-face').click();
  const box = await page.getByTestId('bed-view').boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2 - 40);
  await page.waitForFunction(() => /· 12 layers/.test(document.querySelector('[data-testid=estimate]')?.textContent ?? ''));
  await page.getByTestId('group-turn').locator('summary').click();
  await page.getByTestId('option-copies').fill('200');
  await page.getByTestId('option-copies').blur();
  await page.waitForSelector('[data-testid=bed][data-fits=false]');
  await page.getByTestId('option-copies').fill('1');
  await page.getByTestId('option-copies').blur();
  await page.waitForSelector('[data-testid=bed][data-fits=true]');
  assert.deepEqual(wrong.filter((w) => !w.includes('422')), []);
});

test('the job is shown in 3D quickly, and can be cut at any layer; layers count from 1', async (t) => {
  const { page, wrong } = await openPage(browser, `${studio.address}#make`, t);
  await page.getByTestId('estimate').waitFor();
  await page.getByTestId('option-layer').fill('400');
  await page.getByTestId('slice').click();
  // While a job is sliced, its newest layer is shown.
  await page.waitForFunction(() => window.pliant.job.value?.manifest.layers.length === 30, undefined, { timeout: 60_000 });
  await page.waitForSelector('[data-testid=under-way]', { state: 'detached' });
  await page.getByTestId('layer').fill('1');
  assert.match(await page.locator('.layer-info').textContent(), /layer 1 of 30/);
  const begin = Date.now();
  await page.getByTestId('make-stack').click();
  await page.waitForSelector('[data-testid=stack-view][data-state=shown]');
  const took = Date.now() - begin;
  t.diagnostic(`30 layers in 3D after ${took} ms`);
  assert.ok(took < 10_000, `${took} ms`); // on a busy computer; a second on an idle one
  await page.waitForTimeout(500);
  const whole = await drawn(page, 'stack-view');
  assert.ok(whole > 3000, `${whole} pixels of the whole`);
  await page.getByTestId('stack-layer').fill('3');
  assert.match(await page.locator('.layer-info').textContent(), /up to layer 3 of 30/);
  await page.waitForTimeout(800);
  const low = await drawn(page, 'stack-view');
  assert.ok(low > 500 && low < 0.9 * whole, `${low} of ${whole} pixels after the cut`);
  assert.deepEqual(wrong, []);
});

test('the emergency stop has one place in the window, in every section and above every dialog', async (t) => {
  const { page } = await openPage(browser, `${studio.address}#print`, t);
  await takeTwin(page, '60');
  await startPrint(page);
  await page.waitForSelector('[data-testid=enlarge-light]'); // a print that is paused before its first exposure shows none
  await page.getByTestId('pause').click();
  await page.getByTestId('resume').waitFor();
  for (const width of [320, 390, 600, 768, 900, 901, 1100, 1440, 2560]) {
    await page.setViewportSize({ width, height: 720 });
    const places = new Set();
    const look = async (where) => {
      const box = await page.getByTestId('emergency').boundingBox();
      assert.ok(box.x >= 0 && box.y >= 0 && box.x + box.width <= width && box.y + box.height <= 720, `${where} at ${width}: ${JSON.stringify(box)}`);
      const hit = await page.evaluate(([x, y]) => document.elementFromPoint(x, y)?.closest('[data-testid]')?.dataset.testid, [box.x + box.width / 2, box.y + box.height / 2]);
      assert.equal(hit, 'emergency', `${where} at ${width}: nothing covers it`);
      places.add(JSON.stringify(box));
    };
    for (const section of ['simulate', 'make', 'print']) {
      await page.getByTestId(`section-${section}`).click();
      await look(section);
    }
    await page.evaluate(() => document.querySelectorAll('main, .steer, .print').forEach((e) => e.scrollTo(0, 1e6)));
    await page.evaluate(() => window.scrollTo(0, 1e6));
    await look('scrolled down');
    await page.evaluate(() => window.scrollTo(0, 0));
    await page.getByTestId('enlarge-light').click({ force: true });
    await page.getByTestId('enlarged').waitFor();
    await look('over the enlarged image');
    await page.keyboard.press('Escape');
    await page.getByTestId('enlarged').waitFor({ state: 'detached' });
    assert.equal(places.size, 1, `at ${width}: ${[...places].join(' ')}`);
  }
});

test('a print is reported in the tab\'s title, by a command, and by a verdict with a picture; the camera is shown', async (t) => {
  const { page, wrong } = await openPage(browser, `${studio.address}#print`, t);
  await page.getByTestId('resume').waitFor();
  assert.match(await page.title(), /^Paused, \d+ % finger · Pliant studio$/);
  assert.match(await page.locator('link[rel~=icon]').getAttribute('href'), /^data:image\/svg/);
  await page.waitForSelector('[data-testid=webcam][data-state=shown]');
  assert.ok(pictures > 0);
  const policy = (await fetch(studio.address)).headers.get('content-security-policy');
  assert.ok(policy.includes(`img-src 'self' blob: data: http://127.0.0.1:${camera.address().port}`), policy);
  const names = page.locator('.names span');
  assert.deepEqual((await names.allTextContents()).slice(0, 3), ['platform', '1 semi-flex', '2 rigid-flex']);
  await page.getByTestId('resume').click();
  await page.waitForFunction(() => document.querySelector('[data-testid=print-state]')?.textContent === 'Printed', undefined, { timeout: 120_000 });
  assert.equal(await page.title(), 'Printed: finger · Pliant studio');
  await page.getByTestId('verdict').waitFor({ timeout: 60_000 });
  const passed = (await page.getByTestId('verdict').getAttribute('data-passed')) === 'true';
  assert.equal(await page.getByTestId('reasons').count(), passed ? 0 : 1, 'what failed says why');
  await page.waitForFunction(() => document.querySelector('[data-testid=verdict-picture] img')?.naturalWidth > 1000);
  await page.getByTestId('verdict-picture').click();
  await page.getByTestId('enlarged').waitFor();
  await page.keyboard.press('Escape');
  for (let k = 0; k < 100 && !existsSync(join(folder, 'heard')); ++k) await page.waitForTimeout(100);
  assert.equal(readFileSync(join(folder, 'heard'), 'utf8'), 'finished: finger is printed\n');
  await page.getByTestId('leave').click();
  await page.getByTestId('take-twin').waitFor();
  assert.equal(await page.title(), 'Pliant studio');
  assert.deepEqual(wrong.filter((w) => !w.includes('/snap.png')), []);
});

test('findings of slicing are marked in 3D, and a mark leads to its layer', async (t) => {
  // A roof on one leg, and a ball that nothing holds.
  writeFileSync(join(folder, 'island.toml'), `name = "island"
length_unit = "mm"
material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.45, resin = "semi-flex" }
body = [
  { name = "leg", material = "soft", geometry = { box = [[0, 0, 0], [10, 10, 10]] } },
  { name = "ball", material = "soft", geometry = { box = [[20, 0, 5], [24, 4, 10]] } },
]
fixed = [{ name = "clamp", box = [[0, 0, 0], [10, 10, 0.1]] }]
mesh = { size = "5 mm" }
`);
  execFileSync(program, ['slice', join(folder, 'island.toml'), '--printer', 'tower', '--layer', '1 mm', '-q', '-o', join(folder, 'island.zip')]);
  const { page } = await openPage(browser, `${studio.address}#make`, t);
  await page.waitForFunction(() => window.pliant?.post || window.pliant?.send);
  await page.getByTestId('open').click();
  await page.locator('.open-list .item', { hasText: 'island.zip' }).click();
  await page.locator('.issue', { hasText: 'mid-air' }).first().waitFor();
  assert.match(await page.locator('.issue', { hasText: 'mid-air' }).first().textContent(), /layer 6/); // 5 mm up in layers of 1
  await page.getByTestId('make-stack').click();
  await page.waitForSelector('[data-testid=stack-view][data-state=shown]');
  await page.waitForFunction(() => document.querySelector('.mark')?.style.visibility === 'visible');
  await page.locator('.mark').first().click();
  await page.getByTestId('layer-view').waitFor();
  assert.match(await page.locator('.layer-info').textContent(), /layer 6 of 10/);
});
