// SPDX-License-Identifier: BSD-3-Clause
// The variables that a problem's states have, and its checker.
#pragma once

#include "leeway/io/model.hpp"

#include <string>

namespace leeway::io::detail
{

/// Fills group, variables and variable_names of a problem that has a robot. @param group_name empty: all variables @throws Error
void selectGroup( const RobotModel& model, const std::string& group_name, Problem& problem );

/// Makes the checker of a problem that has all else.
/// @param def its margins, max_d, prepare and previous are used @param file, element, remedy of an error @throws Error
void makeChecker(
    lw_checker_def def, const std::string& file, const std::string& element, const std::string& remedy, Problem& problem );

} // namespace leeway::io::detail
