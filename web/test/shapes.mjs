// Files of geometry for the tests.

/// A box from the origin, as text.
export function boxStl([x, y, z]) {
  const p = (k) => [k & 1 ? x : 0, k & 2 ? y : 0, k & 4 ? z : 0].join(' ');
  const quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
  const facet = (a, b, c) => `facet normal 0 0 0\nouter loop\nvertex ${p(a)}\nvertex ${p(b)}\nvertex ${p(c)}\nendloop\nendfacet\n`;
  return `solid box\n${quads.map(([a, b, c, d]) => facet(a, b, c) + facet(a, c, d)).join('')}endsolid box\n`;
}
