// The things of docs/newcomer.md, done in their order in the browser with as many clicks as it says.
import assert from 'node:assert/strict';
import { readFileSync, rmSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { execFileSync } from 'node:child_process';
import { join } from 'node:path';
import { boxStl } from './shapes.mjs';
import { openPage, program, settled, startBrowser, startPrint, startStudio, takeTwin } from './studio.mjs';

const manual = readFileSync(new URL('../../docs/newcomer.md', import.meta.url), 'utf8');
const rows = [...manual.matchAll(/^\| ([^|]+) \| ([^|]+) \| (\d+) \|$/gm)].map((m) => ({ task: m[1].trim(), clicks: Number(m[3]) }));
let browser;
let studio;

before(async () => {
  studio = await startStudio();
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
  const folder = studio?.folder;
  await studio?.stop();
  if (folder) rmSync(folder, { recursive: true, force: true });
});

const tell = (page, pattern) => page.waitForFunction((p) => new RegExp(p).test(document.querySelector('[data-testid=estimate]')?.textContent ?? ''), pattern);

/// By the task's name in the manual. `click` counts.
const tasks = {
  'open my STL and pull a cable through it': async (page, click) => {
    await page.evaluate((text) => {
      const data = new DataTransfer();
      data.items.add(new File([text], 'mine.stl'));
      document.body.dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true }));
    }, boxStl([60, 12, 10]));
    await page.getByTestId('geometry-new').waitFor({ timeout: 60_000 });
    await click(page.getByTestId('geometry-new'));
    await page.waitForFunction(() => window.pliant.scene.value?.head.robot === 'mine', undefined, { timeout: 120_000 });
    await settled(page);
    await click(page.getByTestId('tab-build'));
    await click(page.getByTestId('place-cable'));
    for (const [k, x] of [4, 30, 56].entries()) {
      const [left, top] = await page.evaluate((p) => window.pliant.project(p), [x, 6, 10]);
      const box = await page.getByTestId('view').boundingBox();
      await click({ click: () => page.mouse.click(box.x + left, box.y + top) });
      await page.waitForFunction((n) => document.querySelector('.placing')?.textContent.includes(n === 1 ? '1 point' : `${n} points`), k + 1);
    }
    await click(page.getByTestId('finish-cable'));
    await page.waitForFunction(() => window.pliant.scene.value?.head.actuators.length === 1, undefined, { timeout: 120_000 });
    await settled(page);
    await click(page.getByTestId('tab-move'));
    await page.getByTestId('number-cable 1').fill('0.93');
    await page.getByTestId('number-cable 1').press('Enter');
    await page.waitForFunction(() => Math.abs(window.pliant.frame.value?.head.cables[0].ratio - 0.93) < 1e-4, undefined, { timeout: 120_000 });
  },
  'see another robot': async (page, click) => {
    await click(page.getByTestId('open'));
    await click(page.locator('.open-list .item', { hasText: 'tutorial finger' }));
    await click(page.getByTestId('discard'));
    await page.waitForFunction(() => document.querySelector('[data-testid=open] .title').textContent === 'finger');
    await settled(page);
  },
  'bend it, and colour it by stress': async (page) => {
    const slider = page.getByTestId('actuator-flexor').locator('input[type=range]');
    const before = await page.getByTestId('number-flexor').inputValue();
    const box = await slider.boundingBox();
    await page.mouse.move(box.x + box.width * 0.9, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width * 0.7, box.y + box.height / 2, { steps: 4 });
    await page.mouse.up();
    await page.waitForFunction((b) => document.querySelector('[data-testid=number-flexor]').value !== b, before);
    await page.getByTestId('field').selectOption('von_mises');
    assert.equal(await page.getByTestId('field').inputValue(), 'von_mises');
  },
  'know whether it fits the printer, and what it takes': async (page, click) => {
    await click(page.getByTestId('section-make'));
    await tell(page, 'layers');
    assert.equal(await page.getByTestId('bed').getAttribute('data-fits'), 'true');
  },
  'lay it on another face': async (page, click) => {
    await page.getByTestId('option-layer').fill('1000');
    await tell(page, '· 12 layers');
    await click(page.getByTestId('lay-on-face'));
    // The front of the finger in the middle of the picture.
    const box = await page.getByTestId('bed-view').boundingBox();
    await click({ click: () => page.mouse.click(box.x + box.width / 2, box.y + box.height / 2) });
    await page.waitForFunction(() => document.querySelector('[data-testid=lay-on-face]').textContent === 'Lay on face');
  },
  'paint where supports are wanted': async (page, click) => {
    await click(page.getByTestId('paint'));
    const box = await page.getByTestId('bed-view').boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(x - 20, y);
    await page.mouse.down();
    await page.mouse.move(x + 20, y, { steps: 4 });
    await page.mouse.up();
    assert.ok(await page.getByTestId('brush-undo').isEnabled(), 'a stroke was painted');
    await click(page.getByTestId('brush-done'));
  },
  'make a job of it': async (page, click) => {
    await click(page.getByTestId('slice'));
    await page.getByTestId('layer-view').waitFor();
  },
  'look into the job': async (page, click) => {
    await click(page.getByTestId('make-stack'));
    await page.waitForSelector('[data-testid=stack-view][data-state=shown]');
    await page.getByTestId('stack-layer').fill('5');
    assert.match(await page.locator('.layer-info').textContent(), /up to layer 5 of \d+/);
  },
  'set up a machine': async (page, click) => {
    await click(page.getByTestId('section-print'));
    await click(page.getByTestId('wizard-machine'));
    for (let step = 1; step <= 4; ++step) {
      await click(page.getByTestId('wizard-next'));
      await page.waitForSelector(`[data-testid=wizard][data-step="${step}"]`);
    }
    assert.match(readFileSync(join(studio.folder, 'my_printer.toml'), 'utf8'), /# The prototype of the thesis/);
    await click(page.getByTestId('wizard-next'));
    await page.getByTestId('wizards').waitFor();
  },
  'print it on the virtual printer': async (page, click) => {
    // The wizard has left its printer in the form; the job is for the other one.
    await page.getByTestId('section-make').click();
    await page.getByTestId('printer').selectOption('tower');
    await click(page.getByTestId('section-print'));
    await click(page.getByTestId('take-twin'));
    await page.waitForSelector('[data-testid=print-state]');
    for (const box of await page.locator('.checklist input').all()) await click(box);
    await click(page.getByTestId('start'));
    await page.waitForFunction(() => Number(document.querySelector('[data-testid=print-layer]')?.textContent) >= 1, undefined, { timeout: 120_000 });
  },
  'stop everything': async (page, click) => {
    await click(page.getByTestId('emergency'));
    await page.getByTestId('stopped').waitFor({ timeout: 60_000 });
  },
  'get a report': async (page, click) => {
    const download = page.waitForEvent('download');
    await click(page.getByTestId('print-report'));
    assert.match(readFileSync(await (await download).path(), 'utf8'), /<html/);
  },
  'resume a print after the plug was pulled': async (page, click) => {
    // What has happened before: a print of a saved job, and the end of the program in the middle of it.
    const example = (name) => new URL(`../../examples/${name}`, import.meta.url).pathname;
    execFileSync(program, ['slice', example('tutorial/finger.toml'), '--printer', example('printers/tower.toml'), '--layer', '1 mm', '-q', '-o', join(studio.folder, 'pulled.zip')]);
    await page.getByTestId('leave').click();
    await page.getByTestId('take-twin').waitFor();
    await page.getByTestId('open').click();
    await page.locator('.open-list .item', { hasText: 'pulled.zip' }).click();
    await page.waitForFunction(() => window.pliant.job.value?.file === 'pulled.zip');
    await takeTwin(page, '60');
    await startPrint(page);
    await page.waitForFunction(() => Number(document.querySelector('[data-testid=print-layer]')?.textContent) >= 2, undefined, { timeout: 120_000 });
    studio.child.kill('SIGKILL');
    await page.getByTestId('lost').waitFor();
    const { folder } = studio;
    studio = await startStudio([], folder, Number(new URL(studio.address).port));
    await page.getByTestId('section-simulate').click();
    await page.waitForFunction(() => window.pliant.online.value && window.pliant.job.value === null, undefined, { timeout: 60_000 });
    // And this is what it takes.
    await click(page.getByTestId('section-print'));
    await click(page.getByTestId('journals').locator('button', { hasText: 'pulled' }));
    await click(page.getByTestId('open-interrupted'));
    await click(page.getByTestId('take-twin'));
    await click(page.getByTestId('go-on'));
    await page.waitForFunction(() => Number(document.querySelector('[data-testid=print-layer]')?.textContent) >= 3, undefined, { timeout: 120_000 });
  },
};

test('the tasks of a new user take the number of clicks that the manual states', async (t) => {
  assert.deepEqual(rows.map((r) => r.task), Object.keys(tasks), 'the manual and this test list the same tasks');
  const { page } = await openPage(browser, studio.address, t, { viewport: { width: 1440, height: 900 } });
  await settled(page);
  for (const { task, clicks } of rows) {
    let n = 0;
    await tasks[task](page, async (what) => {
      ++n;
      await what.click();
    });
    assert.equal(n, clicks, task);
  }
});
