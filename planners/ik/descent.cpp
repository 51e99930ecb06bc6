// SPDX-License-Identifier: BSD-3-Clause
// Damped least squares within bounds: the steps of all inverse kinematics here.
#include "ik/descent.hpp"

namespace leeway::ik
{
namespace
{

constexpr int most_steps = 80;
constexpr double longest_step = 1;     // radians or metres of one freedom
constexpr double solved_cost = 1e-22;  // squared metres: errors of 1e-11
constexpr double stalled_share = 1e-3; // a step that gains a smaller share of the cost is a poor one
constexpr int most_poor_steps = 6;
constexpr double first_damping = 1, least_damping = 1e-6, most_damping = 1e9;
constexpr double damping_floor = 1e-14;
constexpr double least_pivot = 1e-300;

/// normal = J J^T + damping over the columns of J that move and are not fixed, then weights = normal^-1 wanted by its Cholesky
/// factors without square roots. Rows is known for most goals: six are a third faster so.
template <int Rows>
void weightsFor( const Eigen::MatrixXd& jacobian, const std::vector<Eigen::Index>& moving, const std::vector<char>& fixed,
    const Eigen::VectorXd& wanted, double damping, Eigen::MatrixXd& normal_storage, Eigen::VectorXd& weights_storage )
{
	const Eigen::Index rows = Rows == Eigen::Dynamic ? jacobian.rows() : Rows;
	Eigen::Map<Eigen::Matrix<double, Rows, Rows>> normal( normal_storage.data(), rows, rows );
	Eigen::Map<Eigen::Matrix<double, Rows, 1>> weights( weights_storage.data(), rows );
	normal.setZero();
	normal.diagonal().setConstant( damping );
	for ( const Eigen::Index k : moving )
	{
		if ( fixed[static_cast<std::size_t>( k )] == 0 )
		{
			const Eigen::Map<const Eigen::Matrix<double, Rows, 1>> column( jacobian.data() + k * rows, rows );
			for ( Eigen::Index j = 0; j < rows; ++j )
			{
				normal.col( j ) += column[j] * column;
			}
		}
	}
	weights = wanted;
	for ( Eigen::Index j = 0; j < rows; ++j ) // below the diagonal: the factor; on it: one over the pivot
	{
		const double inverse = 1 / std::max( normal( j, j ), least_pivot );
		for ( Eigen::Index i = j + 1; i < rows; ++i )
		{
			const double factor = normal( i, j ) * inverse;
			for ( Eigen::Index k = i; k < rows; ++k )
			{
				normal( k, i ) -= factor * normal( k, j );
			}
			weights[i] -= factor * weights[j];
		}
		normal( j, j ) = inverse;
	}
	for ( Eigen::Index j = rows - 1; j >= 0; --j )
	{
		for ( Eigen::Index i = j + 1; i < rows; ++i )
		{
			weights[j] -= normal( i, j ) * weights[i];
		}
		weights[j] *= normal( j, j );
	}
}

} // namespace

Descent::Descent( const Chain& chain, const std::vector<bool>& moving, std::size_t row_count )
    : m_chain( chain ), m_fixed( chain.freedoms().size() )
{
	const auto freedoms = static_cast<Eigen::Index>( chain.freedoms().size() );
	const auto rows = static_cast<Eigen::Index>( row_count );
	m_residual = m_next_residual = m_weights = Eigen::VectorXd::Zero( rows );
	m_jacobian = m_next_jacobian = Eigen::MatrixXd::Zero( rows, freedoms );
	m_normal = Eigen::MatrixXd::Zero( rows, rows );
	m_step = Eigen::VectorXd::Zero( freedoms );
	std::size_t variables = 0;
	for ( std::size_t i = 0; i < chain.freedoms().size(); ++i )
	{
		const Freedom& freedom = chain.freedoms()[i];
		variables = std::max<std::size_t>( variables, freedom.variable + ( freedom.turn < 0 ? 1 : 4 ) );
		if ( moving[i] )
		{
			m_moving.push_back( static_cast<Eigen::Index>( i ) );
		}
	}
	m_try.resize( variables );
}

/// m_step = A^T (A A^T + damping)^-1 wanted, where A is the Jacobian without the columns of fixed freedoms.
void Descent::solveFor( const Eigen::VectorXd& wanted, double damping )
{
	const auto solve = m_jacobian.rows() == 6 ? weightsFor<6> : weightsFor<Eigen::Dynamic>;
	solve( m_jacobian, m_moving, m_fixed, wanted, damping, m_normal, m_weights );
	for ( const Eigen::Index k : m_moving )
	{
		m_step[k] = m_fixed[static_cast<std::size_t>( k )] != 0 ? 0 : m_jacobian.col( k ).dot( m_weights );
	}
}

const Eigen::VectorXd& Descent::leastChange( const Eigen::VectorXd& wanted, double damping )
{
	std::fill( m_fixed.begin(), m_fixed.end(), char( 0 ) );
	solveFor( wanted, damping );
	return m_step;
}

/// A step after which freedoms at a bound are not further out: these stay, and the others step again without them.
void Descent::stepWithinBounds( const Bounds& bounds, const double* q, double damping )
{
	std::fill( m_fixed.begin(), m_fixed.end(), char( 0 ) );
	bool again = true;
	for ( std::size_t round = 0; again && round <= m_moving.size(); ++round )
	{
		solveFor( m_residual, damping );
		again = false;
		for ( const Eigen::Index k : m_moving )
		{
			const Freedom& freedom = m_chain.freedoms()[static_cast<std::size_t>( k )];
			const double value = freedom.turn < 0 ? q[freedom.variable] : 0;
			m_step[k] = -m_step[k];
			const bool out = ( m_step[k] < 0 && value <= bounds.lower[k] ) || ( m_step[k] > 0 && value >= bounds.upper[k] );
			again = again || out;
			m_fixed[static_cast<std::size_t>( k )] |= char( out );
		}
	}
	const double largest = m_step.cwiseAbs().maxCoeff();
	if ( largest > longest_step )
	{
		m_step *= longest_step / largest;
	}
}

/// to = from moved by m_step, quaternions of length 1.
void Descent::move( const double* from, double* to ) const
{
	std::copy( from, from + m_try.size(), to );
	for ( const Eigen::Index k : m_moving )
	{
		const Freedom& freedom = m_chain.freedoms()[static_cast<std::size_t>( k )];
		if ( freedom.turn < 0 )
		{
			to[freedom.variable] += m_step[k];
		}
		else if ( freedom.turn == 0 )
		{
			double* const r = to + freedom.variable;
			const Eigen::Quaterniond turned = Eigen::Quaterniond( r[3], r[0], r[1], r[2] ).normalized() *
			                                  Eigen::Quaterniond( exponential( m_step.segment<3>( k ) ) );
			Eigen::Map<Eigen::Vector4d> quaternion( r );
			quaternion = turned.normalized().coeffs(); // x, y, z, w
		}
	}
}

void Descent::clamp( const Bounds& bounds, double* q ) const
{
	const std::vector<Freedom>& freedoms = m_chain.freedoms();
	for ( std::size_t i = 0; i < freedoms.size(); ++i )
	{
		const auto k = static_cast<Eigen::Index>( i );
		if ( freedoms[i].turn < 0 )
		{
			double& value = q[freedoms[i].variable];
			value = std::clamp( value, bounds.lower[k], bounds.upper[k] );
		}
	}
}

bool Descent::run( Errors& errors, const Bounds& bounds, double* q )
{
	clamp( bounds, q );
	evaluate( errors, q );
	double cost = m_residual.squaredNorm(), damping = first_damping;
	int poor = 0;
	for ( int i = 0; i < most_steps && cost > solved_cost && poor < most_poor_steps; ++i )
	{
		stepWithinBounds( bounds, q, damping * cost + damping_floor );
		move( q, m_try.data() );
		clamp( bounds, m_try.data() );
		errors.evaluate( m_try.data(), m_next_residual, m_next_jacobian );
		const double next = m_next_residual.squaredNorm();
		if ( next < cost )
		{
			poor = next > ( 1 - stalled_share ) * cost ? poor + 1 : 0;
			std::copy( m_try.begin(), m_try.end(), q );
			m_residual.swap( m_next_residual );
			m_jacobian.swap( m_next_jacobian );
			cost = next;
			damping = std::max( 0.1 * damping, least_damping );
		}
		else
		{
			++poor;
			damping = std::min( 10 * damping, most_damping );
		}
	}
	return cost <= solved_cost;
}

} // namespace leeway::ik
