import { render } from 'preact';
import { App } from './app';
import './style.css';
import { text } from './simulate/editor';
import * as store from './store';
import './theme';

window.addEventListener('hashchange', () => {
  const name = location.hash.slice(1).split('?')[0] as store.Section;
  if (['simulate', 'make', 'print'].includes(name)) store.section.value = name;
});
// For the tests and for the curious: the state of the page.
Object.assign(window, { pliant: { ...store, robotText: text } });
store.connect();
render(<App />, document.getElementById('app') as HTMLElement);
