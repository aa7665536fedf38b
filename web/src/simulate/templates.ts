// Templates of new robots.
const head = (name: string) => `name = "${name}"
length_unit = "mm"

[parameters]
`;

export const templates: Record<string, string> = {
  'Finger with a cable': `${head('finger')}length = 80        # of the finger
width = 14
height = 12

[[body]]
name = "finger"
material = "dragon-skin-30"
geometry = { box = [[0, 0, 0], ["= length", "= width", "= height"]] }

[mesh]
size = "5 mm"

[[fixed]]
name = "clamp"
box = [[0, 0, 0], [0, "= width", "= height"]]

[[cable]]
name = "flexor"
points = [[0, "= width / 2", "= height - 2"], ["= length / 2", "= width / 2", "= height - 2"], ["= length", "= width / 2", "= height - 2"]]
anchor = "first"
eyelet_radius = "2 mm"
target = { length_ratio = 0.9 }

[[marker]]
name = "tip"
point = ["= length", "= width / 2", "= height / 2"]
`,
  'Bending chamber': `${head('bender')}length = 60        # of the body
wall = 3           # above the chamber; below it is twice as thick

[[body]]
name = "bender"
material = "dragon-skin-30"
geometry = { box = [[0, 0, 0], ["= length", 16, "= 8 + 3 * wall"]] }

[mesh]
size = "4 mm"

[[fixed]]
name = "base"
box = [[0, 0, 0], [0, 16, "= 8 + 3 * wall"]]

[[chamber]]
name = "air"
geometry = { box = [[5, 4, "= 2 * wall"], ["= length - 5", 12, "= 2 * wall + 8"]] }
target = { pressure = "10 kPa" }

[[marker]]
name = "tip"
point = ["= length", 8, "= wall"]
`,
  'Beam under its weight': `${head('beam')}length = 100       # of the beam

[[body]]
name = "beam"
material = "ecoflex-00-30"
geometry = { box = [[0, 0, 0], ["= length", 20, 20]] }

[mesh]
size = "8 mm"

[[fixed]]
name = "wall"
box = [[0, 0, 0], [0, 20, 20]]

[[marker]]
name = "end"
point = ["= length", 10, 10]

[program]
gravity = [0, 0, -9.81]
`,
};
