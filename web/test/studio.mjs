// A studio and a browser for the tests.
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createRequire } from 'node:module';

const require = createRequire(join(process.env.PLIANT_WEB ?? new URL('..', import.meta.url).pathname, 'package.json'));
const { chromium } = require('playwright-core');

export const program = process.env.PLIANT_PROGRAM ?? 'build/release/apps/pliant/pliant';

/// A studio on a free port, in a folder of its own.
export async function startStudio(args = [], cwd = undefined) {
  const folder = cwd ?? mkdtempSync(join(tmpdir(), 'pliant_web_'));
  const child = spawn(program, ['studio', '--port', '0', '-q', ...args], { cwd: folder, stdio: ['ignore', 'pipe', 'inherit'] });
  const address = await new Promise((resolve, reject) => {
    let text = '';
    child.stdout.on('data', (data) => {
      text += data;
      if (text.includes('\n')) resolve(text.trim());
    });
    child.on('exit', (code) => reject(new Error(`the studio ended with ${code}`)));
  });
  return {
    address,
    folder,
    child,
    async stop() {
      const ended = new Promise((resolve) => child.on('exit', (code, signal) => resolve(signal ?? code)));
      child.kill('SIGINT');
      const how = await ended;
      if (!cwd) rmSync(folder, { recursive: true, force: true });
      return how;
    },
  };
}

export async function startBrowser() {
  return chromium.launch({
    executablePath: process.env.PLIANT_CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist', '--disable-dev-shm-usage'],
  });
}

/// A page that looks at the studio; what it should not do (errors, foreign addresses) is collected in `wrong`.
export async function openPage(browser, address, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(60000);
  const wrong = [];
  page.on('pageerror', (error) => wrong.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && wrong.push(message.text()));
  page.on('request', (request) => {
    const url = request.url();
    if (!url.startsWith(new URL(address).origin) && !url.startsWith('blob:') && !url.startsWith('data:')) wrong.push(`asked for ${url}`);
  });
  await page.goto(address);
  return { page, context, wrong };
}

/// The robot is there and at equilibrium.
export async function settled(page) {
  await page.waitForSelector('[data-testid=status][data-state=arrived]');
}
