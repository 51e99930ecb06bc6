// SPDX-License-Identifier: BSD-3-Clause
// Depths of rows in contact: their derivatives against finite differences, and rows that are apart.
#include "near_world.hpp"

namespace
{

class NearDepths : public NearTest
{
protected:
	NearDepths() : NearTest( 7000 )
	{
		def.distance = 0.2;
		def.depth_steps = 256;
	}
};

TEST_P( NearDepths, HaveOtherSlopesThanTheirDerivatives )
{
	const double h = 1e-5;
	int compared = 0;
	for ( int i = 0; i < 20; ++i )
	{
		const std::vector<double> q = randomGroupState( world, rng );
		const NearRows near = rows( q );
		ASSERT_EQ( LW_OK, near.status );
		for ( std::size_t v = 0; v < q.size(); ++v )
		{
			std::vector<double> less = q, more = q;
			less[v] -= h;
			more[v] += h;
			const auto low = clearances( less ), high = clearances( more );
			for ( std::size_t k = 0; k < near.rows.size(); ++k )
			{
				const lw_near_pair& row = near.rows[k];
				const double width = row.clearance.upper - row.clearance.lower;
				const auto before_it = low.find( bodiesOf( row ) ), after_it = high.find( bodiesOf( row ) );
				if ( row.clearance.kind != LW_CLEARANCE_VIOLATION || row.clearance.upper > -1e-3 || width > 1e-10 ||
				     before_it == low.end() || after_it == high.end() )
				{
					continue;
				}
				const double before = ( row.clearance.upper - before_it->second ) / h;
				const double after = ( after_it->second - row.clearance.upper ) / h;
				const double slope = near.derivatives[k * q.size() + v];
				const double error = 2 * width / h + 1e-4 + std::sqrt( 2 * width / -row.clearance.upper );
				EXPECT_GE( slope, std::min( before, after ) - error ) << "row " << k << " variable " << v;
				EXPECT_LE( slope, std::max( before, after ) + error ) << "row " << k << " variable " << v;
				++compared;
			}
		}
	}
	std::printf( "%d slopes\n", compared );
}

TEST_P( NearDepths, ChangeRowsThatAreApart )
{
	for ( int i = 0; i < 10; ++i )
	{
		const std::vector<double> q = randomGroupState( world, rng );
		const NearRows with = rows( q );
		lw_near_def plain = def;
		plain.depth_steps = 0;
		const NearRows without = nearPairs( world.with_tables.get(), query.get(), q, plain );
		ASSERT_EQ( without.total, with.total );
		std::map<BodyPair, lw_near_pair> known;
		for ( const lw_near_pair& row : without.rows )
		{
			known[bodiesOf( row )] = row;
		}
		for ( const lw_near_pair& row : with.rows )
		{
			const lw_near_pair& before = known.at( bodiesOf( row ) );
			EXPECT_EQ( before.clearance.kind, row.clearance.kind );
			if ( row.clearance.kind != LW_CLEARANCE_VIOLATION )
			{
				EXPECT_EQ( before.clearance.upper, row.clearance.upper );
				continue;
			}
			EXPECT_LE( row.clearance.upper, before.clearance.upper );
			EXPECT_LE( row.clearance.lower, row.clearance.upper );
			EXPECT_EQ( LW_DIRECTION_NONE, before.direction );
			EXPECT_LE( with.links[row.clearance.a], row.clearance.lower );
		}
	}
}

INSTANTIATE_TEST_SUITE_P( Random, NearDepths, testing::Range( 0, 30 ) );

} // namespace
