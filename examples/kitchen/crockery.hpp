// SPDX-License-Identifier: BSD-3-Clause
// The small things of the kitchen: each stands on z = 0 with its axis at the origin.
#pragma once

#include "geometry.hpp"

namespace kitchen
{

Mesh makePlate();
Mesh makeBowl( double radius, double height );
Mesh makeCup(); ///< with a handle towards +x
Mesh makeGlass();
Mesh makeWineBottle();
Mesh makeMilkBottle();
Mesh makeJar();
Mesh makeJarLid();
Mesh makePan(); ///< its handle points to +x
Mesh makePot(); ///< two handles along x
Mesh makePotLid();
Mesh makeKettle();
Mesh makeFruit( double radius, double squash );
Mesh makeSpoon(); ///< lies along x
Mesh makeFork();
Mesh makeKnife();
Mesh makeLeaves(); ///< of a plant whose pot is 0.12 m high
Mesh makePlantPot();
Mesh makePendant(); ///< lamp shade, hollow, opening downwards at z = 0
Mesh makeTableLamp();
Mesh makeLampShade();
Mesh makeDishRack();
Mesh makeBread();
Mesh makeUtensilJar();
Mesh makeUtensils();

} // namespace kitchen
