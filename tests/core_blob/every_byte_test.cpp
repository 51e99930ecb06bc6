// SPDX-License-Identifier: BSD-3-Clause
// One blob with every section that there is (every type of shape, a reach with hulls and tables), cut short at every byte
// and with every byte changed: as it is, which the checksum tells, and with the checksum made right, which leaves it to the
// reader. Reads past the end are the sanitizers' to see: bytes are in heap blocks of exactly their size.
#include "blob_support.hpp"
#include "leeway/detail.h"
#include "shape/shape.h"

#include <cmath>

namespace
{
struct RobotDeleter
{
	void operator()( lw_robot* robot ) const { lw_robot_release( robot ); }
};
struct ReachDeleter
{
	void operator()( lw_reach* reach ) const { lw_reach_release( reach ); }
};
using ReachPtr = std::unique_ptr<lw_reach, ReachDeleter>;

class EveryByte : public ::testing::Test
{
protected:
	void SetUp() override
	{
		addShapes();
		makeRobot();
		reach.reset( randomReach( robot.get(), 5 ) );
		std::vector<const lw_shape*> pointers;
		for ( const ShapePtr& shape : shapes )
		{
			pointers.push_back( shape.get() );
		}
		blob = std::make_unique<Bytes>( writeBlob( pointers, reach.get() ) );
		lw_blob_info info = {};
		ASSERT_EQ( LW_OK, lw_blob_get_info( blob->begin(), blob->size(), nullptr, &info ) );
		ASSERT_EQ( shapes.size(), info.shape_count );
		ASSERT_TRUE( info.has_reach );
	}

	void add( lw_status status, lw_shape* shape )
	{
		ASSERT_EQ( LW_OK, status );
		shapes.emplace_back( shape );
	}

	void addShapes()
	{
		lw_shape* shape = nullptr;
		const lw_tree_def small = []
		{
			lw_tree_def d = lw_tree_def_default();
			d.leaf_size = 2;
			return d;
		}();
		shapes.push_back( randomSoup( rng, 9, 1.0, small ) ); // inner nodes and leaves
		const double points[12] = { 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0 }, balls[8] = { 0, 0, 0, 1, 1, 1, 0, 0.5 };
		const double boxes[12] = { 0, 0, 0, 1, 1, 1, 2, 0, 0, 3, 1, 0 };
		const std::uint32_t faces[12] = { 0, 1, 2, 0, 1, 3, 0, 2, 3, 1, 2, 3 };
		lw_mesh_def solid = lw_mesh_def_default();
		solid.vertices = points, solid.vertex_count = 4, solid.indices = faces, solid.triangle_count = 4, solid.solid = true;
		lw_status status = lw_shape_create_mesh( &solid, nullptr, nullptr, &shape );
		add( status, shape );
		status = lw_shape_create_points( points, 4, 0.1, nullptr, nullptr, nullptr, &shape );
		add( status, shape );
		status = lw_shape_create_spheres( balls, 2, nullptr, nullptr, nullptr, &shape );
		add( status, shape );
		status = lw_shape_create_boxes( boxes, 2, nullptr, nullptr, nullptr, &shape );
		add( status, shape );
		ShapePtr fine = randomSoup( rng, 6, 0.05 );
		status = lw_shape_create_detail( fine.get(), 0.1, nullptr, nullptr, nullptr, &shape );
		add( status, shape );
		for ( int type : { LW_SHAPE_BOX, LW_SHAPE_SPHERE, LW_SHAPE_CYLINDER, LW_SHAPE_CAPSULE, LW_SHAPE_CONE,
		          LW_SHAPE_HALFSPACE, LW_SHAPE_PLANE } )
		{
			shapes.push_back( makePrimitive( static_cast<lw_shape_type>( type ), 1, 2, 3 ) );
		}
	}

	/// Three links in a row, one body each.
	void makeRobot()
	{
		const char* names[3] = { "a", "b", "c" };
		lw_joint_def joints[2];
		lw_body_def bodies[3];
		for ( std::uint32_t i = 0; i < 3; ++i )
		{
			bodies[i] = { shapes[i].get(), i, lw_transform_identity() };
			if ( i < 2 )
			{
				joints[i] = lw_joint_def_default();
				joints[i].name = names[i];
				joints[i].type = LW_JOINT_REVOLUTE;
				joints[i].parent = i;
				joints[i].child = i + 1;
				joints[i].axis[2] = 1;
				joints[i].lower = -1;
				joints[i].upper = 1;
			}
		}
		lw_robot_def def = lw_robot_def_default();
		def.name = "row";
		def.link_names = names;
		def.link_count = 3;
		def.joints = joints;
		def.joint_count = 2;
		def.bodies = bodies;
		def.body_count = 3;
		lw_robot* made = nullptr;
		lw_diag diag = {};
		ASSERT_EQ( LW_OK, lw_robot_create( &def, nullptr, &diag, &made ) ) << diag.message;
		robot.reset( made );
	}

	ReachPtr readReach( const Bytes& bytes, lw_status* status ) const
	{
		lw_reach* out = nullptr;
		*status = lw_blob_read_reach( bytes.begin(), bytes.size(), test_key, robot.get(), nullptr, nullptr, &out );
		return ReachPtr( out );
	}

	void expectDamaged( const Bytes& bytes, std::size_t at ) const
	{
		lw_blob_info info = {};
		lw_status status = LW_OK;
		ASSERT_EQ( LW_ERROR_DAMAGED, lw_blob_get_info( bytes.begin(), bytes.size(), nullptr, &info ) ) << at;
		ASSERT_EQ( LW_ERROR_DAMAGED, readStatus( bytes, shapes.size() ) ) << at;
		ASSERT_EQ( nullptr, readReach( bytes, &status ) ) << at;
		ASSERT_EQ( LW_ERROR_DAMAGED, status ) << at;
	}

	/// Refused, or shapes and a reach that are sound. @return true if any of it was let in
	bool readsSoundly( const Bytes& bytes, lw_query* query )
	{
		lw_status of_shapes = LW_OK, of_reach = LW_OK;
		const std::vector<ShapePtr> loaded = readShapes( bytes, shapes.size(), &of_shapes );
		const ShapePtr& probe = shapes[0];
		const lw_transform here = lw_transform_identity(), there = at( 0.3, 0.2, 0.1 );
		for ( const ShapePtr& shape : loaded )
		{
			lw_clearance out;
			EXPECT_EQ( LW_OK, lwi_shape_validate( shape.get(), nullptr ) );
			EXPECT_EQ( LW_OK, lw_shape_distance( shape.get(), &here, probe.get(), &there, nullptr, query, &out ) );
			EXPECT_LE( out.lower, out.upper );
		}
		const ReachPtr read = readReach( bytes, &of_reach );
		for ( std::uint32_t link = 0; read != nullptr && link < 3; ++link )
		{
			EXPECT_FALSE( std::isnan( lw_reach_get_node( read.get(), link ).m.radius ) );
			for ( std::uint32_t other = 0; other < 3; ++other )
			{
				EXPECT_GE( lw_reach_get_pair( read.get(), link, other ).separation, 0.0 );
			}
		}
		return of_shapes == LW_OK || of_reach == LW_OK;
	}

	SeededRng rng;
	std::vector<ShapePtr> shapes;
	std::unique_ptr<lw_robot, RobotDeleter> robot;
	ReachPtr reach;
	std::unique_ptr<Bytes> blob;
};

} // namespace

TEST_F( EveryByte, CutShortIsDamage )
{
	for ( std::size_t size = 0; size < blob->size(); ++size )
	{
		expectDamaged( Bytes( blob->begin(), size ), size );
	}
}

TEST_F( EveryByte, ChangedIsDamage )
{
	for ( std::size_t at = 0; at < blob->size(); ++at )
	{
		unsigned char& byte = blob->begin()[at];
		const unsigned char before = byte;
		byte = static_cast<unsigned char>( before ^ 1 << rng.integer( 0, 7 ) );
		expectDamaged( *blob, at );
		byte = before;
	}
	lw_status status = LW_OK;
	EXPECT_EQ( LW_OK, readStatus( *blob, shapes.size() ) );
	EXPECT_NE( nullptr, readReach( *blob, &status ) );
}

TEST_F( EveryByte, CutShortAndSealedIsRefused )
{
	QueryPtr query = makeQuery();
	for ( std::size_t size = LWI_BLOB_TABLE; size < blob->size(); ++size )
	{
		Bytes cut( blob->begin(), size );
		cut.put( LWI_BLOB_SIZE, std::uint64_t( size ) );
		cut.seal();
		readsSoundly( cut, query.get() ); // shapes may be whole where the reach is gone
		ASSERT_FALSE( HasFailure() ) << size;
	}
}

TEST_F( EveryByte, ChangedAndSealedIsRefusedOrSound )
{
	QueryPtr query = makeQuery();
	const std::size_t payload = LWI_BLOB_TABLE;
	int accepted = 0, refused = 0;
	for ( std::size_t at = payload; at < blob->size(); ++at )
	{
		const unsigned char before = blob->begin()[at];
		for ( int change : { 1 << rng.integer( 0, 7 ), 0x80, 0xff } )
		{
			Bytes bytes( blob->begin(), blob->size() );
			bytes.begin()[at] = static_cast<unsigned char>( before ^ change );
			bytes.seal();
			++( readsSoundly( bytes, query.get() ) ? accepted : refused );
			ASSERT_FALSE( HasFailure() ) << "byte " << at << " ^ " << change;
		}
	}
	std::printf( "%d bytes, %d changes accepted in part or whole, %d refused\n", static_cast<int>( blob->size() ), accepted,
	    refused );
	EXPECT_GT( accepted, 100 );
}
