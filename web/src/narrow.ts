// Whether the window is so narrow that views and panels are below one another, as in style.css.
import { signal } from '@preact/signals';

const query = matchMedia('(max-width: 900px)');
export const narrow = signal(query.matches);
query.addEventListener('change', () => (narrow.value = query.matches));
