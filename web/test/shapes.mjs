// Robots and files of geometry for the tests.

/// A box from the origin, as text.
export function boxStl([x, y, z]) {
  const p = (k) => [k & 1 ? x : 0, k & 2 ? y : 0, k & 4 ? z : 0].join(' ');
  const quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
  const facet = (a, b, c) => `facet normal 0 0 0\nouter loop\nvertex ${p(a)}\nvertex ${p(b)}\nvertex ${p(c)}\nendloop\nendfacet\n`;
  return `solid box\n${quads.map(([a, b, c, d]) => facet(a, b, c) + facet(a, c, d)).join('')}endsolid box\n`;
}

/// A robot that is solved in a moment, with a cavity of its own.
export function block(modulus) {
  return `name = "block"
length_unit = "mm"

[parameters]
length = 40   # along x

[material.soft]
youngs_modulus = "${modulus}"
poisson_ratio = 0.45

[[body]]
name = "block"
material = "soft"
geometry = { difference = [{ box = [[0, 0, 0], ["= length", 12, 12]] }, { box = [[8, 4, 4], [20, 8, 8]] }] }

[mesh]
size = "6 mm"
order = 1

[[fixed]]
name = "clamp"
box = [[0, 0, 0], [0, 12, 12]]

[[cable]]
name = "flexor"
points = [[0, 6, 11], [20, 6, 11], [40, 6, 11]]
target = { shortening = "1 mm" }

[[marker]]
name = "tip"
point = ["= length", 6, 6]
`;
}
