"""Sensors of the simulated robot: what each would report, from the motion that the physics produced.

No sensor knows the physics engine: they take `mounting.PointMotion` and belt travels, and the lidar a
function that casts rays. Each draws its noise from a generator of its own, so that switching one
sensor's settings does not change the noise of another.
"""
