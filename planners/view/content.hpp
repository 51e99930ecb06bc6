// SPDX-License-Identifier: BSD-3-Clause
// The contents of a page: robot, scene, motion and overlays as JSON and bytes.
#pragma once

#include "leeway/io/spheres.hpp"
#include "view/encode.hpp"
#include "view/steps.hpp"

#include <map>
#include <string>
#include <vector>

namespace leeway::view
{

/// One of several motions of a page.
struct NamedMotion
{
	std::string name; ///< as the page's choice has it
	ViewMotion motion;
};

/// A number of each step of the motion, which the page draws below the clearances.
struct Curve
{
	std::string name, unit;     ///< as the page names it; the unit may be empty
	std::vector<double> values; ///< [steps], from 0 on; NaN: none
};

struct PageInput
{
	const io::RobotModel& robot;
	const io::SceneModel* scene; ///< may be null
	const io::Problem& problem;
	ViewMotion motion; ///< at least one step
	lw_check_flags flags = LW_CHECK_BOTH;
	double min_d = 0;
	std::size_t triangles = 5000;                 ///< shown of one mesh
	bool live = true;                             ///< the page holds the engine's shapes too
	std::vector<io::LinkSpheres> spheres = {};    ///< of `spherize`; empty: none
	std::string source = {};                      ///< of the motion, a file name; empty: none
	std::string robot_file = {}, scene_file = {}; ///< as the page names them
	std::vector<std::string> notes = {};          ///< sentences that the page repeats
	ProgressFunction progress = {};               ///< may be empty
	/// Motions of the same group beside `motion`, to compare with; of the same unit.
	std::vector<NamedMotion> more = {};
	std::vector<Curve> curves = {}; ///< of `motion`
	std::string chapter = {};       ///< of several worlds: the name of this one
};

struct PageContent
{
	Json json;
	PageBytes bytes;                  ///< of meshes and spheres
	std::vector<double> numbers;      ///< of the engine; empty: the page has none
	std::string blob;                 ///< shapes of the engine
	std::vector<std::string> omitted; ///< sentences: shapes that are simplified or not shown
};

/// @throws io::Error, CoreError
PageContent pageContent( const PageInput& page );

/// The distinct shapes of robot and scene, in the order of their first use.
class ShapeList
{
public:
	explicit ShapeList( const io::Problem& problem );
	std::size_t indexOf( const lw_shape* shape ) const { return m_index.at( shape ); }
	const std::vector<const lw_shape*>& shapes() const { return m_shapes; }
	/// "link upper", "object table": the first user.
	const std::string& owner( std::size_t shape ) const { return m_owners[shape]; }

private:
	void add( const lw_shape* shape, const std::string& owner );
	std::vector<const lw_shape*> m_shapes;
	std::vector<std::string> m_owners;
	std::map<const lw_shape*, std::size_t> m_index;
};

/// A joint as the page and its engine need it: from the description, since the core keeps its own form.
std::vector<io::JointModel> jointsOf( const io::RobotModel& model, const lw_robot* robot );

/// Shapes for display; appends to content.bytes and content.omitted.
Json shapesJson( const ShapeList& shapes, std::size_t budget, const ProgressFunction& progress, PageContent& content );
/// Motion hulls, if the checker has a reach, and spheres of `spherize`.
void addOverlays( const PageInput& page, PageContent& content );
/// Numbers and blob of the engine.
void addEngine( const PageInput& page, const ShapeList& shapes, PageContent& content );

} // namespace leeway::view
