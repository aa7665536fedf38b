// The ten things of docs/newcomer.md, done in their order in the browser with as many clicks as it says.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { openPage, settled, startBrowser, startStudio } from './studio.mjs';

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
  await studio?.stop();
});

const tell = (page, pattern) => page.waitForFunction((p) => new RegExp(p).test(document.querySelector('[data-testid=estimate]')?.textContent ?? ''), pattern);

/// By the task's name in the manual. `click` counts.
const tasks = {
  'see another robot': async (page, click) => {
    await click(page.getByTestId('open'));
    await click(page.locator('.open-list .item', { hasText: 'tutorial finger' }));
    await page.waitForFunction(() => document.querySelector('[data-testid=open] .title').textContent === 'finger');
    await settled(page);
  },
  'bend it': async (page) => {
    const slider = page.getByTestId('actuator-flexor').locator('input[type=range]');
    const before = await page.getByTestId('number-flexor').inputValue();
    const box = await slider.boundingBox();
    await page.mouse.move(box.x + box.width * 0.9, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width * 0.7, box.y + box.height / 2, { steps: 4 });
    await page.mouse.up();
    await page.waitForFunction((b) => document.querySelector('[data-testid=number-flexor]').value !== b, before);
  },
  'colour it by stress': async (page) => {
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
  'print it on the virtual printer': async (page, click) => {
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
};

test('ten tasks of a newcomer, each with the clicks that the manual counts', async (t) => {
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
