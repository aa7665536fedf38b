import { render } from 'preact';
import { App } from './app';
import './style.css';
import { text } from './simulate/editor';
import { theView } from './simulate/the_view';
import { shownFrame } from './simulate/view_state';
import * as store from './store';
import './theme';

window.addEventListener('hashchange', () => {
  const name = location.hash.slice(1).split('?')[0] as store.Section;
  if (['simulate', 'make', 'print'].includes(name)) store.section.value = name;
});
// The state of the page, for tests and debugging.
const shown = () => shownFrame.value ?? store.frame.value;
const project = (p: [number, number, number]) => theView.value?.placeOnPage(p);
Object.assign(window, { pliant: { ...store, robotText: text, shown, project } });
void store.claimPageKey().then(store.connect);
const root = document.getElementById('app') as HTMLElement;
root.replaceChildren(); // what index.html shows until here
render(<App />, root);
