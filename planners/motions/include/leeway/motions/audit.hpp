// SPDX-License-Identifier: BSD-3-Clause
// The independent audit of a path: dense exact states, no certificates.
#pragma once

#include "leeway/motions/states.hpp"

#include <string>
#include <vector>

namespace leeway::motions
{

/// A place on a path.
struct PathPlace
{
	std::size_t edge = 0; ///< from point `edge` to the next
	double t = 0;         ///< on that edge, 0 to 1
	double s = 0;         ///< share of the path's length, 0 to 1
};

struct AuditSample
{
	PathPlace place;
	/// Metres, exact; +inf if not asked. Inside of a margin: of the first pair found at or below 0.
	double environment = 0, self = 0;
};

struct AuditLeast
{
	Named clearance;
	PathPlace place;
};

struct AuditSettings
{
	double min_d = 0;
	/// Metres: near contact no robot point moves more than this between two measured states.
	double resolution = 1e-4;
	lw_check_flags flags = LW_CHECK_BOTH;
	double time = 60;          ///< seconds, after which it ends where it is: the path is then not valid
	ProgressFunction progress; ///< may be empty
	/// An audit that needs more states is an error before it begins: some hours of work.
	static constexpr double most_states = 1e8;
};

struct Audit
{
	bool valid = false;
	std::vector<std::string> problems; ///< why not: the first violations, limits, ends that differ from the request
	std::size_t states = 0;
	double length = 0; ///< of the path, joint space
	AuditLeast environment, self;
	/// No state between two measured ones comes closer than this, by the measured motion; may be a little below the margin.
	double environment_between = 0, self_between = 0;
	std::vector<AuditSample> samples;
	double seconds = 0;
};

/// Measures the path's states so densely that no robot point moves further between two of them than the larger of the
/// resolution and a quarter of the room there is. Motion is measured from forward kinematics here, not taken from the
/// motion bounds that the certified edges use; distances are exact ones, with a query of its own.
/// @param points group states, at least one; edges between them are straight
/// Cost: at least a state for each tenth of a radian or metre that all joints together travel.
/// @throws io::Error naming `file`; a path that needs more than AuditSettings::most_states by that
Audit auditPath( const io::Problem& problem, const std::vector<std::vector<double>>& points, const AuditSettings& settings,
    const std::string& file );

/// Adds to the audit's problems if the path does not begin at the request's start, as numbers (a whole turn away is elsewhere), with all
/// joints that the request names, or does not end at its goal, where angles that wrap may be whole turns away.
void auditEnds(
    const io::Problem& problem, const io::Request& request, const std::vector<std::vector<double>>& points, Audit& audit );

/// Least clearances in equal stretches of the path's length.
std::vector<AuditSample> profile( const Audit& audit, std::size_t stretches );

/// Lines for people.
std::string describe( const Audit& audit, const AuditSettings& settings, std::size_t points );
/// All samples: s,edge,t,environment,self
std::string profileCsv( const Audit& audit );

} // namespace leeway::motions
