// SPDX-License-Identifier: BSD-3-Clause
// The variables that a problem's states have.
#pragma once

#include "leeway/io/model.hpp"

#include <string>

namespace leeway::io::detail
{

/// Fills group, variables and variable_names of a problem that has a robot. @param group_name empty: all variables @throws Error
void selectGroup( const RobotModel& model, const std::string& group_name, Problem& problem );

} // namespace leeway::io::detail
