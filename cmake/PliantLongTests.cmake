# The tests that take over some 20 s on two cores: they get the label `long`.
set(PLIANT_LONG_TESTS
  simulation/run/random_programs
  simulation/peers/peer/calculix
  studio/page
  studio/print_page
  studio/true_page
  studio/visual_page
  print/kill
  examples/cable_gripper/make
  examples/printed_as_drawn
  examples/gripper_holds_a_ball
  simulation/scene/reference/real_mesh
  document/docs/tutorial
  document/examples/printed/README
)
