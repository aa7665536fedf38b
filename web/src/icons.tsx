// Line icons, drawn on a grid of 20.
const paths: Record<string, string> = {
  play: 'M6 4.5v11l9-5.5z',
  pause: 'M6.5 4.5v11M13.5 4.5v11',
  stop: 'M5.5 5.5h9v9h-9z',
  rest: 'M4 10a6 6 0 1 0 2-4.5M4 3.5v3h3',
  record: 'M10 5.5a4.5 4.5 0 1 1 0 9a4.5 4.5 0 0 1 0-9z',
  save: 'M4 4h9.5L16 6.5V16H4zM7 4v4h5V4M7 16v-4.5h6V16',
  save_as: 'M16 9.5V6.5L13.5 4H4v12h5.5M7 4v4h5V4M14 12v6M11 15h6',
  undo: 'M4 8.5h8a4 4 0 0 1 0 8H8M7 5L3.5 8.5L7 12',
  redo: 'M16 8.5H8a4 4 0 0 0 0 8h4M13 5l3.5 3.5L13 12',
  sun: 'M10 6.5a3.5 3.5 0 1 1 0 7a3.5 3.5 0 0 1 0-7zM10 2v2M10 16v2M2 10h2M16 10h2M4.3 4.3l1.400 1.400M14.3 14.3l1.400 1.400M4.3 15.7l1.400-1.400M14.3 5.7l1.400-1.400',
  moon: 'M15.5 12.5A6.5 6.5 0 0 1 7.5 4.5a6.5 6.5 0 1 0 8 8z',
  download: 'M10 3.5v9M6.5 9l3.5 3.5L13.5 9M4 16h12',
  frame: 'M4 7V4h3M13 4h3v3M16 13v3h-3M7 16H4v-3',
  helm: 'M10 4.5a5.5 5.5 0 1 1 0 11a5.5 5.5 0 0 1 0-11zM10 2v16M2 10h16',
  warn: 'M10 3.5L17 16H3zM10 8v4M10 14v.2',
  check: 'M4.5 10.5l3.5 3.5l7.5-8',
  open: 'M3.5 15.5v-11h5l1.5 2h6.5v9z',
  up: 'M5 12l5-5l5 5',
  down: 'M5 8l5 5l5-5',
  left: 'M12 5l-5 5l5 5',
  right: 'M8 5l5 5l-5 5',
  help: 'M7.5 7.5a2.5 2.5 0 1 1 3.6 2.3c-.8.4-1.1.9-1.1 1.7M10 14v.2M10 2.5a7.5 7.5 0 1 1 0 15a7.5 7.5 0 0 1 0-15z',
  close: 'M5.5 5.5l9 9M14.5 5.5l-9 9',
  layers: 'M10 3.5l7 3.5l-7 3.5l-7-3.5zM3 10.5l7 3.500l7-3.500M3 14l7 3.500l7-3.500',
  pin: 'M7 3.5h6l-1 5l2 2.5H6l2-2.5zM10 11v5.5',
};

export function Icon({ name }: { name: string }) {
  return (
    <svg class="icon" viewBox="0 0 20 20" aria-hidden="true">
      <path d={paths[name]} />
    </svg>
  );
}
