// The panel that is open beside the view.
import { signal } from '@preact/signals';

export const panel = signal<'move' | 'build' | 'plots' | 'file' | 'goal' | 'workspace' | 'identify' | 'sweep'>('move');
