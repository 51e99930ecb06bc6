// SPDX-License-Identifier: BSD-3-Clause
// Audits as JSON: the reports of `leeway audit`, and what the Python package returns.
#pragma once

#include "leeway/motions/audit.hpp"
#include "leeway/motions/roundings.hpp"
#include "leeway/motions/schedule.hpp"
#include "leeway/motions/trajectory.hpp"
#include "motions/json.hpp"

namespace leeway::motions
{

Json toJson( const Audit& audit, const AuditSettings& settings );
Json toJson( const RoundingAudit& audit );
Json toJson( const TrajectoryAudit& audit );
Json toJson( const ScheduleAudit& audit );

} // namespace leeway::motions
