"""Belt-force model: what the ground does to two tracks, compiled with numba.

The chassis is one rigid body of Bullet's; belts and wheels are no bodies. In every step

1. `geometry` lays each belt as straight bars under idlers and road wheels, and `probes` asks Bullet which bodies of the
   world they touch (`touch` makes contacts of that); `ground` adds the floor and says what friction holds where;
2. `normal_load` finds the contacts' loads together with the suspension, linearly implicit in the wheels' rates:
   `suspension_law` is the exact X structure, a linear spring, or nothing when the wheels are locked to the chassis;
3. `shear` turns sliding into forces: each bar has a bristle whose deflection grows with sliding, travels rearwards with
   the belt and saturates in the friction ellipse (Janosi and Hanamoto), so that the robot holds on a slope and slips in
   a turn;
4. `step` gathers all that into one force and torque on the chassis, and `drives` moves the belts against the ground.

Left out: tension and inertia of the belt around the idlers, grousers, deformable soil, and the vertical inertia of the
wheels in the chassis' equation (2 kg against 10 kg; kept in the plane, and vertically when locked).
"""
