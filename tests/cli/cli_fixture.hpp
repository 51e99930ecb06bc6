// SPDX-License-Identifier: BSD-3-Clause
// A folder with a small robot, a scene and requests, and the program run in it.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

/// Result of one run of the program.
struct Outcome
{
	int status = -1;
	std::string out, err;
};

/// Runs the program with these arguments in `folder`.
Outcome runLeeway( const std::string& folder, const std::vector<std::string>& arguments );

/// A table as the program writes it.
struct Table
{
	std::vector<std::string> header;
	std::vector<std::map<std::string, std::string>> rows;
	double number( std::size_t row, const std::string& column ) const;
};
Table parseTable( const std::string& text );

std::string readFile( const std::string& path );
bool contains( const std::string& text, const std::string& part );

/// A planar arm: post `base` (box, disc-like), `upper` (0.4 m box from the z axis along +x), `fore` (0.4 m mesh box beyond
/// it), a fixed `tool` and a `finger` that mimics the elbow, both without geometry. Joints shoulder and elbow turn about z;
/// at zero the arm's tip is at x = 0.8. The scene's wall has its face at x = 0.9, so the clearance at zero is 0.1. The post
/// of the scene `blocked.yaml` stands at x = 0.6: the straight way from shoulder -1 to 1 is blocked, with a folded elbow
/// there is one.
class Cli : public testing::Test
{
protected:
	void SetUp() override;
	void TearDown() override;

	std::string path( const std::string& name ) const { return m_folder + "/" + name; }
	void write( const std::string& name, const std::string& text ) const;
	/// Writes `name` as it stands with `from` replaced by `to`; fails the test if `from` is not in it.
	void edit( const std::string& name, const std::string& from, const std::string& to ) const;
	Outcome run( const std::vector<std::string>& arguments ) const { return runLeeway( m_folder, arguments ); }
	/// subcommand --robot arm.urdf --srdf arm.srdf --scene scene.yaml + more
	Outcome runModel(
	    const std::string& subcommand, const std::vector<std::string>& more, const std::string& scene = "scene.yaml" ) const;
	std::vector<std::string> files() const;

	std::string m_folder;
};
