// SPDX-License-Identifier: BSD-3-Clause
// The classes of the module behind their Python faces, and one function for each part of the module.
#pragma once

#include "leeway/handles.hpp"
#include "leeway/io/world.hpp"
#include "leeway/motions/trajectory.hpp"

#include "arrays.hpp"

#include <nlohmann/json_fwd.hpp>

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace leeway::python
{

/// leeway.Robot: immutable.
struct PyRobot
{
	explicit PyRobot( io::RobotModel read );
	std::shared_ptr<const io::RobotModel> model;
	Robot robot; ///< of the core, without attached objects
};

/// leeway.Scene: the model, which Python edits.
struct PyScene
{
	io::SceneModel model;
};

/// Queries of one checker, one for each thread that works.
class QueryPool
{
public:
	explicit QueryPool( Checker checker ) : m_checker( std::move( checker ) ) {}
	Query take();
	void giveBack( Query query );

private:
	Checker m_checker;
	std::mutex m_mutex;
	std::vector<Query> m_free;
};

/// A query of a pool, given back at the end of the scope.
class Lease
{
public:
	explicit Lease( QueryPool& pool ) : m_pool( pool ), m_query( pool.take() ) {}
	~Lease() { m_pool.giveBack( std::move( m_query ) ); }
	Lease( const Lease& ) = delete;
	Lease& operator=( const Lease& ) = delete;
	lw_query* get() const { return m_query.get(); }

private:
	QueryPool& m_pool;
	Query m_query;
};

/// What certificates and bubbles of a checker have alike, made when it is needed: certificates.cpp
struct Certifier;
std::shared_ptr<Certifier> newCertifier(
    std::shared_ptr<const io::Problem> problem, std::shared_ptr<const io::RobotModel> model );

/// leeway.Checker: a snapshot, immutable.
struct PyChecker
{
	PyChecker( std::shared_ptr<const io::Problem> made, std::shared_ptr<const io::RobotModel> robot );
	std::shared_ptr<const io::Problem> problem;
	std::shared_ptr<const io::RobotModel> model; ///< of `problem`
	/// Changes of the scene begin with it, as long as it is in the state `of_world`; empty: the scene is not changed.
	std::shared_ptr<const io::World> world;
	std::shared_ptr<const io::Problem> of_world;
	std::shared_ptr<QueryPool> queries;
	std::shared_ptr<Certifier> certifier; ///< what certificates and bubbles have alike
	const lw_checker* get() const { return problem->checker.get(); }
	std::size_t variables() const { return problem->variables.size(); }
};

/// leeway.Cloud: one call at a time.
struct PyCloud
{
	PyCloud( const lw_cloud_def& def, unsigned threads ) : cloud( def, threads ) {}
	std::mutex mutex;
	io::Cloud cloud;
};

/// leeway.Reach
struct PyReach
{
	io::LoadedReach loaded;
};

/// Arguments of a checker or a world.
struct ProblemArguments
{
	std::string group;
	nb::object reference;
	std::vector<std::pair<std::string, std::string>> allowed;
	nb::object margins, padding;
	const PyReach* reach = nullptr;
	double min_d = 0, max_d = 0;
};

/// Options of io::buildProblem(). @param scene may be null @throws nb::value_error, io::Error
io::ProblemOptions optionsOf( const PyRobot& robot, const io::SceneModel* scene, const ProblemArguments& arguments );

/// Shapes of an object: a shape, or a list of (shape, pose). Poses are in the object's frame.
std::vector<io::PlacedShape> placedShapes( const nb::object& shapes );

/// LW_CHECK_* by its name: "both", "environment", "self". @throws nb::value_error
lw_check_flags checkFlags( const std::string& name );

/// The 4 x 4 matrices, lists and names of an io::LoadReport's notices: "file: element: text" lines.
std::vector<std::string> noticeLines( const std::vector<io::Notice>& notices );

/// Calls `work( query, begin, end )` for blocks of [0, count), on `threads` threads (0: one for each core), without the interpreter's lock.
/// Each block begins with a query that was reset, so answers do not depend on threads or on earlier calls. Ctrl-C ends it between blocks.
void inBlocks( QueryPool& queries, std::size_t count, std::size_t block, unsigned threads,
    const std::function<void( lw_query*, std::size_t, std::size_t )>& work );

/// A report as the program writes it into a file, read by Python: the same keys, and the same numbers in all digits.
nb::object dictOf( const nlohmann::ordered_json& json );

/// An instance of a class of leeway.results.
nb::object result( const char* type, const nb::tuple& values );

void bindShapes( nb::module_& module );
void bindRobots( nb::module_& module );
void bindScenes( nb::module_& module );
void bindClouds( nb::module_& module );
void bindCheckers( nb::module_& module );
void bindStates( nb::class_<PyChecker>& type );
/// Raises the error of row i of states that the library refused. @throws CoreError
[[noreturn]] void failState( lw_status status, const Rows& rows, std::size_t i );
void bindNear( nb::class_<PyChecker>& type );
void bindMotions( nb::class_<PyChecker>& type );
/// Arrays as a trajectory of the checker's variables. @throws nb::value_error
motions::TrajectoryFile trajectoryOf( const PyChecker& checker, const Doubles& times, const nb::object& positions,
    const nb::object& velocities, const nb::object& accelerations );
/// The trajectories of a file, or of arrays. @param times seconds, or the name of a file @throws nb::value_error, io::Error
std::vector<motions::TrajectoryFile> trajectoriesOf( const PyChecker& checker, const nb::object& times,
    const nb::object& positions, const nb::object& velocities, const nb::object& accelerations );
/// By its name. @throws nb::value_error
motions::Interpolation interpolationOf( const std::string& name );
/// [variables] of the argument, else of the trajectory's goal. @throws nb::value_error, io::Error
std::vector<double> toleranceOf( const PyChecker& checker, const std::string& file,
    const std::map<std::string, double>& of_goal, const nb::object& given );
/// Of a file that is given by its name; empty for anything else.
std::string fileName( const nb::object& given );
void bindAudits( nb::module_& module, nb::class_<PyChecker>& type );
void bindReferee( nb::class_<PyChecker>& type );
void bindCertificates( nb::class_<PyChecker>& type );
void bindGoals( nb::class_<PyChecker>& type );
void bindPlans( nb::module_& module, nb::class_<PyChecker>& type );
void bindReach( nb::module_& module );
void bindTimedWorlds( nb::module_& module );
void bindGuards( nb::module_& module );
void bindInverses( nb::module_& module );
void bindViews( nb::module_& module );

/// The __reduce__ of classes that hold proofs and caches of one process: pickle, copy and multiprocessing call it. @throws nb::type_error
[[noreturn]] void refusePickle( const nb::object& );

/// 32 hexadecimal digits.
std::string digestText( lw_digest digest );

/// State of a shape for pickle: a blob.
nb::bytes shapeState( const Shape& shape );
Shape shapeFromState( const nb::bytes& bytes );
nb::tuple robotState( const PyRobot& robot );
PyRobot robotFromState( const nb::tuple& state );
nb::tuple sceneState( const PyScene& scene );
PyScene sceneFromState( const nb::tuple& state );

} // namespace leeway::python
