// SPDX-License-Identifier: BSD-3-Clause
// xacro files as robots, by the program xacro.
//
// xacro executes Python expressions of the file and of every file that it includes. So it runs only for a file that somebody named as
// the robot and whose content is xacro (LoadOptions::expand_xacro says when), and the libraries below start no program.
#pragma once

#include "leeway/io/model.hpp"

#include <string>
#include <vector>

namespace leeway::tools
{

struct XacroSettings
{
	std::vector<std::string> arguments;     ///< NAME:=VALUE, see isXacroArgument()
	std::vector<std::string> package_paths; ///< as LoadOptions::package_paths, for $(find NAME)
	std::string python = "python3";         ///< an interpreter that may have the module xacro: a path, or a name on $PATH
};

/// NAME:=VALUE, with a NAME of letters, digits and _.
bool isXacroArgument( const std::string& word );

/// Expands a file by the first of: $LEEWAY_XACRO, xacro on $PATH, the module xacro of XacroSettings::python. It runs without a shell, for
/// a minute and up to 64 MB of text at most. $(find NAME) is searched as package://NAME.
/// @throws io::Error that names the file, the last words of the program and the remedy
io::ExpandedRobot expandXacro( const std::string& file, const XacroSettings& settings );

} // namespace leeway::tools
