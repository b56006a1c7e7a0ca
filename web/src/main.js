// SPDX-License-Identifier: Apache-2.0
import './style.css';
import './print.css';

import {batchesSection, driftSection, familySection, fleetNotesSection, fleetRobotsSection, fleetVerdictSection, outOfFamilySection} from './fleet/sections.js';
import {h} from './lib/dom.js';
import {isDark, setTheme} from './lib/theme.js';
import {contactSection, contactVerdictSection} from './sections/contact.js';
import {deploymentSection} from './sections/deployment.js';
import {designSection} from './sections/design.js';
import {findingsSection} from './sections/findings.js';
import {historySection} from './sections/history.js';
import {identifiabilitySection} from './sections/identifiability.js';
import {modelsSection} from './sections/models.js';
import {motionSection} from './sections/motion.js';
import {missingSection, reproduceSection} from './sections/reproduce.js';
import {residualsSection} from './sections/residuals.js';
import {robotSection} from './sections/robot.js';
import {signalSection} from './sections/signal.js';
import {table1Section} from './sections/table1.js';
import {verdictSection} from './sections/verdict.js';

// The order is that of an engineer's questions: can I use it, what is off, can I believe it.
const SECTIONS = [
  verdictSection, robotSection, table1Section, modelsSection, deploymentSection, residualsSection, identifiabilitySection,
  signalSection, designSection, motionSection, historySection, findingsSection, reproduceSection,
  missingSection,
];

// A robot that touched tables has no markers to show.
const SECTIONS_OF_TOUCHES = [
  contactVerdictSection, contactSection, table1Section, robotSection, historySection, findingsSection,
  reproduceSection,
];

// For a fleet: which robots need attention, and what robots have in common.
const SECTIONS_OF_A_FLEET = [
  fleetVerdictSection, fleetRobotsSection, outOfFamilySection, batchesSection, driftSection, familySection, fleetNotesSection,
];

const isFleet = (report) => report.format === 'elastocal-fleet-1';

function sectionsOf(report) {
  if (isFleet(report)) return SECTIONS_OF_A_FLEET;
  return report.summary?.contact ? SECTIONS_OF_TOUCHES : SECTIONS;
}

/** Makes a section. If that fails, a message takes its place and the other sections remain. */
function build(make, report) {
  try {
    return make(report);
  } catch (error) {
    console.error(error);
    return h('section', {class: 'notice'}, `A part of this report cannot be shown: ${error.message}`);
  }
}

const titleOf = (report) => isFleet(report) ? 'Fleet' : report.summary?.robot || report.data?.robot?.name || report.folder || '';

function header(report) {
  const dark = h('button', {type: 'button', class: 'quiet', onclick: () => setTheme(isDark() ? 'light' : 'dark')}, 'Light / dark');
  return h('header', {class: 'top'}, h('p', {class: 'brand'}, h('strong', {}, 'elastocal'), isFleet(report) ? ' fleet report' : ' calibration report'),
    h('h1', {}, titleOf(report) || 'Report'),
    h('p', {class: 'source'}, report.summary?.recording ? `from ${report.summary.recording}` : report.folder ?? ''), dark);
}

const entry = (part) => h('li', {}, h('a', {href: `#${part.id}`}, part.dataset.short));

/** The licences of other people's software in this page (notices.js writes them into the template). */
function licences() {
  const text = document.getElementById('notices').content.textContent;
  return h('details', {id: 'licences'}, h('summary', {}, 'Software of others in this page, and its licences'), h('pre', {}, text));
}

/** Waits until the page so far is painted. A hidden tab is not painted, so it does not wait. */
const painted = () => new Promise((done) => document.hidden ? done() : requestAnimationFrame(() => setTimeout(done)));

/** Shows the robot before the sections below it are made. */
async function show(report) {
  document.title = `${titleOf(report)} – elastocal report`;
  const list = h('ol');
  const main = h('main', {id: 'main'});
  const app = document.getElementById('app');
  app.append(h('a', {class: 'skip', href: '#main'}, 'Skip to the report'), header(report), h('nav', {'aria-label': 'Contents'}, list), main);
  for (const make of sectionsOf(report)) {
    const part = build(make, report);
    if (!part) continue;
    main.append(part);
    if (part.dataset.short) list.append(entry(part));
    if (make === robotSection) await painted();
  }
  app.append(h('footer', {}, h('p', {}, `Made by elastocal ${report.version ?? ''}. This file is complete: it needs no network and no other file.`), licences()));
  document.getElementById(location.hash.slice(1))?.scrollIntoView();
  app.dataset.complete = '';
}

const report = JSON.parse(document.getElementById('report-data').textContent);
if (typeof report === 'string') {
  document.getElementById('app').append(h('p', {class: 'notice'}, 'This is the template of a report; elastocal puts the data in.'));
} else {
  show(report);
}
