// SPDX-License-Identifier: BSD-3-Clause
// The subcommands of leeway-bench, one function and one file each.
#pragma once

#include "support/command.hpp"

void addAuditMotions( Bench& bench );
void addClock( Bench& bench );
void addCloud( Bench& bench );
void addCompare( Bench& bench );
void addEdits( Bench& bench );
void addExperiments( Bench& bench );
void addGuard( Bench& bench );
void addLive( Bench& bench );
void addKernels( Bench& bench );
void addPeers( Bench& bench );
void addReach( Bench& bench );
void addSelf( Bench& bench );
void addStartup( Bench& bench );
void addStates( Bench& bench );
// those that need OMPL
void addAuditEdges( Bench& bench );
void addCells( Bench& bench ); ///< and leeway::motions
void addEdges( Bench& bench );
void addPlanning( Bench& bench );
void addPose( Bench& bench ); ///< and inverse kinematics
