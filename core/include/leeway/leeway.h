// SPDX-License-Identifier: BSD-3-Clause
// leeway: certified clearance and collision queries for motion planning. This header includes all of the core.
#ifndef LEEWAY_H
#define LEEWAY_H

#include "leeway/base.h"
#include "leeway/blob.h"
#include "leeway/checker.h"
#include "leeway/clock.h"
#include "leeway/cloud.h"
#include "leeway/constraint.h"
#include "leeway/depth.h"
#include "leeway/detail.h"
#include "leeway/distance.h"
#include "leeway/guard.h"
#include "leeway/math.h"
#include "leeway/near.h"
#include "leeway/reach.h"
#include "leeway/robot.h"
#include "leeway/scene.h"
#include "leeway/shape.h"
#include "leeway/spheres.h"
#include "leeway/version.h"

#endif
