// SPDX-License-Identifier: BSD-3-Clause
// Values of a YAML file, or errors that name file and element.
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <utility>
#include <vector>

namespace leeway::motions
{

/// All documents of a file that are not empty, parted by lines "---". @param out_bytes its size @throws io::Error for text that is no YAML
std::vector<YAML::Node> loadYaml( const std::string& file, std::size_t* out_bytes );

/// @throws io::Error
double finiteValue( const std::string& file, const YAML::Node& node, const std::string& element );
/// A list of names, each once. @throws io::Error
std::vector<std::string> nameList( const std::string& file, const YAML::Node& node, const std::string& element );
/// A list of so many numbers. @param remedy if it is not @throws io::Error
std::vector<double> numberList( const std::string& file, const YAML::Node& node, const std::string& element,
    std::size_t count, const std::string& remedy );

/// Names and positions of a sensor_msgs/JointState. @throws io::Error
std::vector<std::pair<std::string, double>> jointState(
    const std::string& file, const YAML::Node& joints, const std::string& element );

/// The value of a key if `node` is a map that has it; else a node that is not defined.
inline YAML::Node child( const YAML::Node& node, const char* key )
{
	return node.IsDefined() && node.IsMap() ? node[key] : YAML::Node( YAML::NodeType::Undefined );
}

} // namespace leeway::motions
