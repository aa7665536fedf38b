// Light and dark theme: the system's setting unless the user has chosen one.
import { signal } from '@preact/signals';

type Theme = 'light' | 'dark';
const system = matchMedia('(prefers-color-scheme: dark)');
const chosen = localStorage.getItem('pliant_theme') as Theme | null;
export const theme = signal<Theme>(chosen ?? (system.matches ? 'dark' : 'light'));
system.addEventListener('change', () => {
  if (!localStorage.getItem('pliant_theme')) theme.value = system.matches ? 'dark' : 'light';
});
theme.subscribe((value) => (document.documentElement.dataset.theme = value));

export function toggleTheme() {
  theme.value = theme.value === 'dark' ? 'light' : 'dark';
  localStorage.setItem('pliant_theme', theme.value);
}

export function cssColour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
