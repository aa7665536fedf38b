// Makes the film that the README begins with, from the real page on the real program: a cable is pulled, the robot is
// sliced, and printed on the virtual printer. Ten seconds, as a GIF of the studio's own encoder, a minute or two to make:
//   PLIANT_PROGRAM=$PWD/build/release/apps/pliant/pliant PLIANT_WEB=$PWD/build/release/web node web/test/film.mjs [FILE.gif]
import { copyFileSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { openPage, settled, startBrowser, startPrint, startStudio, takeTwin } from './studio.mjs';

const target = process.argv[2] ?? new URL('../../docs/pictures/studio_film.gif', import.meta.url).pathname;
const robot = new URL('../../examples/cable_gripper/gripper.toml', import.meta.url).pathname;
const require = createRequire(join(process.env.PLIANT_WEB ?? new URL('..', import.meta.url).pathname, 'package.json'));
const size = { width: 1120, height: 680 };
const frame_ms = 100;
const last_ms = 1000;

/// A pointer and a caption, which the pictures of a browser have not.
function drawPointer() {
  const put = (id, style, html) => {
    const e = Object.assign(document.createElement('div'), { id, innerHTML: html });
    e.style.cssText = `position:fixed;z-index:99;pointer-events:none;${style}`;
    document.body.append(e);
  };
  const arrow = '<svg width="22" height="26" viewBox="0 0 11 13"><path d="M1 1v9.5l2.6-2.3 1.7 3.9 1.8-.8-1.7-3.8h3.4z" fill="#111" stroke="#fff"/></svg>';
  put('film-pointer', 'left:0;top:0', arrow);
  put('film-caption', 'right:260px;top:11px;font:600 15px/30px system-ui,sans-serif;color:#fff;background:#0f6f78;border-radius:99px;padding:0 16px', '');
}

class Film {
  constructor(page) {
    this.page = page;
    this.pictures = [];
    this.at = [size.width * 0.6, size.height * 0.6];
  }

  async take(times = 1) {
    const png = (await this.page.screenshot({ animations: 'disabled' })).toString('base64');
    for (let k = 0; k < times; ++k) this.pictures.push(png);
  }

  caption(text) {
    return this.page.evaluate((t) => (document.getElementById('film-caption').textContent = t), text);
  }

  point(x, y) {
    this.at = [x, y];
    return this.page.evaluate(([a, b]) => (document.getElementById('film-pointer').style.transform = `translate(${a}px, ${b}px)`), this.at);
  }

  /// The pointer goes there, in so many pictures.
  async goTo(x, y, pictures = 3) {
    const [x0, y0] = this.at;
    for (let k = 1; k <= pictures; ++k) {
      const t = k / pictures;
      const s = t * t * (3 - 2 * t);
      await this.point(x0 + s * (x - x0), y0 + s * (y - y0));
      await this.take();
    }
  }

  async press(testid, pictures = 3) {
    const box = await this.page.getByTestId(testid).boundingBox();
    await this.goTo(box.x + box.width / 2, box.y + box.height / 2, pictures);
    await this.page.getByTestId(testid).click();
  }
}

async function pull(film) {
  const { page } = film;
  await settled(page);
  await page.getByRole('button', { name: 'Skip' }).click();
  await page.getByTestId('fine').click(); // only exact states: their curves are lines
  await page.waitForTimeout(300);
  await settled(page);
  await film.caption('pull the cable');
  const slider = page.locator('[data-testid=actuator-flexor] input[type=range]').first();
  const { x, y, width, height } = await slider.boundingBox();
  const [low, high] = await slider.evaluate((e) => [Number(e.min), Number(e.max)]);
  const placeOf = (ratio) => x + 9 + ((width - 18) * (ratio - low)) / (high - low) - 4;
  await film.take(2);
  await film.goTo(placeOf(1), y + height / 2);
  const steps = 22;
  for (let k = 1; k <= steps; ++k) {
    const t = k / steps;
    if (k === 2) await page.getByTestId('field').selectOption({ label: 'Von Mises stress' });
    const ratio = 1 - 0.28 * t * t * (3 - 2 * t);
    await page.getByTestId('number-flexor').fill(ratio.toFixed(3));
    await page.keyboard.press('Enter');
    await page.getByTestId('number-flexor').blur();
    await page.waitForTimeout(150);
    await settled(page);
    await film.point(placeOf(ratio), y + height / 2);
    await film.take();
  }
  await film.take(2);
}

async function slice(film) {
  const { page } = film;
  await film.press('section-make');
  await page.getByTestId('estimate').waitFor();
  await page.waitForTimeout(1500); // the camera comes to rest
  await film.caption('slice it');
  await film.take(4);
  await page.getByTestId('option-layer').fill('100');
  await film.press('slice');
  await page.getByTestId('cancel-slice').waitFor({ state: 'detached' });
  await page.getByTestId('make-stack').click();
  await page.waitForSelector('[data-testid=stack-view][data-state=shown]');
  const slider = page.getByTestId('stack-layer');
  const count = Number(await slider.getAttribute('max'));
  const box = await slider.boundingBox();
  for (let k = 1; k <= 12; ++k) {
    const layer = Math.max(1, Math.round((count * k) / 12));
    await slider.evaluate((e, value) => {
      e.value = value;
      e.dispatchEvent(new Event('input', { bubbles: true }));
    }, String(layer));
    await page.waitForTimeout(300);
    await film.point(box.x + box.width / 2 - 4, box.y + box.height * (1 - layer / count));
    await film.take();
  }
  await film.take(3);
  await film.press('make-plan', 2);
  await page.getByTestId('gantt').waitFor();
  await page.waitForTimeout(500);
  await film.take(6);
}

async function print(film) {
  const { page } = film;
  const layerNow = () => page.evaluate(() => Number(document.querySelector('[data-testid=print-layer]')?.textContent) || 0);
  await film.press('section-print', 2);
  await takeTwin(page, '300');
  await film.caption('print it');
  await startPrint(page);
  await page.waitForFunction(() => Number(document.querySelector('[data-testid=print-layer]')?.textContent) >= 2);
  await film.point(size.width * 0.42, size.height * 0.86);
  for (let k = 0; k < 7; ++k) {
    await film.take();
    await page.waitForTimeout(120);
  }
  await page.getByTestId('view-part').click();
  const [first, count, pictures] = [await layerNow(), 150, 13];
  for (let k = 1; k <= pictures; ++k) {
    const layer = first + ((count - 2 - first) * k) / pictures;
    await page.waitForFunction((l) => Number(document.querySelector('[data-testid=print-layer]')?.textContent) >= l || document.querySelector('[data-testid=verdict]'), layer);
    await film.take();
  }
  await page.getByTestId('verdict').waitFor();
  await page.waitForFunction(() => document.querySelector('[data-testid=verdict-picture] img')?.complete);
  await film.caption('cured as drawn');
  await page.getByTestId('verdict').scrollIntoViewIfNeeded();
  await page.locator('.notice').waitFor({ state: 'detached' });
  await film.take(6);
}

/// The encoder of the page runs in a browser: PNG files are decoded there.
async function encoded(browser, pictures) {
  const built = await require('esbuild').build({ entryPoints: [new URL('../src/simulate/gif.ts', import.meta.url).pathname], bundle: true, write: false, format: 'iife', globalName: 'film', logLevel: 'error' });
  const page = await browser.newPage();
  await page.addScriptTag({ content: built.outputFiles[0].text });
  await page.evaluate(() => (window.pictures = []));
  let last = '';
  for (const png of pictures) {
    await page.evaluate(
      async ([data, { width, height }]) => {
        if (!data) return window.pictures.push(window.pictures.at(-1));
        const image = new Image();
        image.src = `data:image/png;base64,${data}`;
        await image.decode();
        const context = Object.assign(document.createElement('canvas'), { width, height }).getContext('2d');
        context.drawImage(image, 0, 0, width, height);
        return window.pictures.push({ data: context.getImageData(0, 0, width, height).data });
      },
      [png === last ? '' : png, size],
    );
    last = png;
  }
  const text = await page.evaluate(
    ([{ width, height }, each, end]) => {
      const bytes = window.film.animatedGif(window.pictures, width, height, each, end);
      let binary = '';
      for (let k = 0; k < bytes.length; k += 8192) binary += String.fromCharCode(...bytes.subarray(k, k + 8192));
      return btoa(binary);
    },
    [size, frame_ms, last_ms],
  );
  return Buffer.from(text, 'base64');
}

const folder = mkdtempSync(join(tmpdir(), 'pliant_film_'));
copyFileSync(robot, join(folder, 'gripper.toml'));
const studio = await startStudio(['gripper.toml'], folder);
const browser = await startBrowser();
try {
  const { page } = await openPage(browser, studio.address, undefined, { viewport: size, colorScheme: 'light' });
  page.setDefaultTimeout(240_000);
  await page.evaluate(drawPointer);
  const film = new Film(page);
  for (const scene of [pull, slice, print]) await scene(film);
  const gif = await encoded(browser, film.pictures);
  writeFileSync(target, gif);
  const seconds = ((film.pictures.length - 1) * frame_ms + last_ms) / 1000;
  console.log(`${target}: ${film.pictures.length} pictures, ${seconds.toFixed(1)} s, ${(gif.length / 1e6).toFixed(2)} MB`);
} finally {
  await browser.close();
  studio.child.kill('SIGKILL');
  rmSync(folder, { recursive: true, force: true });
}
