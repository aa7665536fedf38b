// Draws the pictures of the studio that the README shows, from the real page on the real program, into docs/pictures:
//   PLIANT_PROGRAM=$PWD/build/release/apps/pliant/pliant PLIANT_WEB=$PWD/build/release/web node web/test/pictures.mjs [FOLDER]
import { copyFileSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { openPage, settled, startBrowser, startPrint, startStudio, takeTwin } from './studio.mjs';

const pictures = process.argv[2] ?? new URL('../../docs/pictures', import.meta.url).pathname;
const robot = new URL('../../examples/cable_gripper/gripper.toml', import.meta.url).pathname;

async function shoot(page, name) {
  await page.waitForTimeout(1000); // the camera and the plots come to rest
  await page.screenshot({ path: join(pictures, `studio_${name}.png`) });
}

async function simulate(page) {
  await settled(page);
  await page.getByTestId('field').selectOption({ label: 'Von Mises stress' });
  await page.getByRole('button', { name: 'Skip' }).click();
  await page.getByTestId('fine').click(); // only exact states: their curves are lines
  await page.waitForTimeout(300);
  await settled(page);
  for (let ratio = 0.98; ratio > 0.755; ratio -= 0.02) {
    await page.getByTestId('number-flexor').fill(ratio.toFixed(2));
    await page.keyboard.press('Enter');
    await page.waitForTimeout(300);
    await settled(page);
  }
  await page.getByTestId('number-flexor').blur();
  await shoot(page, 'simulate');
}

async function plan(page) {
  await page.getByTestId('section-make').click();
  await page.getByTestId('option-layer').fill('100');
  await page.getByTestId('slice').click();
  await page.getByTestId('make-plan').click();
  await page.getByTestId('gantt').waitFor({ timeout: 120_000 });
  for (let k = 0; k < 3; ++k) await page.getByTestId('gantt-nearer').click();
  await shoot(page, 'plan');
}

async function print(page) {
  await page.getByTestId('section-print').click();
  await takeTwin(page, '300');
  await startPrint(page);
  await page.waitForFunction(() => Number(document.querySelector('[data-testid=print-layer]')?.textContent) >= 105, undefined, { timeout: 400_000 });
  await page.getByTestId('view-part').click();
  await shoot(page, 'print');
}

const folder = mkdtempSync(join(tmpdir(), 'pliant_pictures_'));
copyFileSync(robot, join(folder, 'gripper.toml'));
const studio = await startStudio(['gripper.toml'], folder);
const browser = await startBrowser();
try {
  const { page } = await openPage(browser, studio.address, undefined, { viewport: { width: 1280, height: 780 } });
  page.setDefaultTimeout(120_000);
  await simulate(page);
  await plan(page);
  await print(page);
} finally {
  await browser.close();
  studio.child.kill('SIGKILL');
  rmSync(folder, { recursive: true, force: true });
}
