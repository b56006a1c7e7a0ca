// SPDX-License-Identifier: Apache-2.0
import {readFileSync} from 'node:fs';
import {pathToFileURL} from 'node:url';

/**
 * Opens a file. `problems`: messages of console, scripts and dialogs. `requests`: all except the file.
 * WebGL in software takes most of the time, so it has a quarter of the pixels, with the same layout.
 */
export async function openPage(browser, file, options = {}) {
  const page = await browser.newPage({viewport: {width: 1280, height: 900}, deviceScaleFactor: 0.5, acceptDownloads: true, ...options});
  const problems = [];
  const requests = [];
  const url = pathToFileURL(file).href;
  page.on('console', (message) => ['error', 'warning'].includes(message.type()) && !isDriverNote(message.text()) && problems.push(message.text()));
  page.on('pageerror', (error) => problems.push(error.message));
  page.on('dialog', (dialog) => { problems.push(`dialog: ${dialog.message()}`); dialog.dismiss(); });
  page.on('request', (request) => !request.url().startsWith('data:') && !request.url().startsWith('blob:') && request.url() !== url && requests.push(request.url()));
  page.setDefaultTimeout(120000);  // WebGL in software is slow beside other work
  await page.goto(url);
  await page.waitForSelector('#app[data-complete]', {state: 'attached'});
  return {page, problems, requests};
}

/** A message of WebGL in software when pixels are read back, which is no fault of the page. */
const isDriverNote = (text) => /GPU stall due to ReadPixels|GL Driver Message/.test(text);

/** Milliseconds from the start of loading to the first picture of the viewer. */
export async function waitForViewer(page) {
  await page.waitForSelector('.viewer[data-ready]');
  return page.getAttribute('.viewer', 'data-ready');
}

/** Contents of the 3-D view: number of drawn pixels, number of colours, and a hash of all. */
export function picture(page, canvas = '.viewer canvas') {
  return page.evaluate(async (selector) => {
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    const source = document.querySelector(selector);
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [source.width, source.height];
    const context = copy.getContext('2d');
    context.drawImage(source, 0, 0);
    const {data} = context.getImageData(0, 0, copy.width, copy.height);
    const colours = new Set();
    let opaque = 0;
    let hash = 0;
    for (let i = 0; i < data.length; i += 4) {
      const colour = data[i] << 16 | data[i + 1] << 8 | data[i + 2];
      if (data[i + 3] === 255) { ++opaque; colours.add(colour); }
      hash = (Math.imul(hash, 31) + colour + data[i + 3]) | 0;
    }
    return {pixels: data.length / 4, opaque, colours: colours.size, hash};
  }, canvas);
}

/** The data that a report holds. */
export function embeddedReport(file) {
  const text = readFileSync(file, 'utf8');
  return JSON.parse(text.match(/<script type="application\/json" id="report-data">([^<]*)<\/script>/)[1]);
}
