// SPDX-License-Identifier: BSD-3-Clause
// A request's constraints along the path for OMPL's spaces on a constraint manifold, beside leeway's StateValidityChecker. Needs OMPL; header only.
//
//     auto manifold = std::make_shared<leeway::manifold::Manifold>( robot, problem, path );
//     auto constraint = std::make_shared<leeway::manifold::OmplConstraint>( manifold );
//     auto space = std::make_shared<ompl::base::ProjectedStateSpace>( leeway::ompl::makeStateSpace( problem.checker ), constraint );
//     auto si = std::make_shared<ompl::base::ConstrainedSpaceInformation>( space );
//     auto engine = std::make_shared<leeway::ompl::Engine>( space, problem.checker, leeway::ompl::Options() );
//     si->setStateValidityChecker( std::make_shared<leeway::ompl::StateValidityChecker>( si, engine ) );
//
// OMPL then samples its motions: states are proved free, motions and constraints between them are not. planPath() proves both.
#pragma once

#include "leeway/manifold/manifold.hpp"

#include <ompl/base/Constraint.h>

#include <cmath>
#include <memory>

namespace leeway::manifold
{

/// One thread uses it. ProjectedStateSpace takes all constraints; AtlasStateSpace and TangentBundleStateSpace need derivatives of full rank
/// everywhere, so only thin rows (Manifold::thinRows() == Manifold::rows()).
class OmplConstraint : public ::ompl::base::Constraint
{
public:
	/// @param tolerance metres and radians, of the errors of all rows
	/// @throws ompl::Exception if there are no fewer variables than rows
	explicit OmplConstraint( std::shared_ptr<Manifold> manifold, double tolerance = 1e-6 )
	    : Constraint( static_cast<unsigned>( manifold->variables() ), static_cast<unsigned>( manifold->rows() ), tolerance ),
	      m_manifold( std::move( manifold ) )
	{
	}

	using Constraint::function;
	using Constraint::jacobian;
	using Constraint::project;

	void function( const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::Ref<Eigen::VectorXd> out ) const override
	{
		Eigen::VectorXd values( out.size() );
		m_manifold->errors( x.data(), values.data(), nullptr );
		out = values;
	}

	void jacobian( const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::Ref<Eigen::MatrixXd> out ) const override
	{
		Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> derivatives( out.rows(), out.cols() );
		m_manifold->errors( x.data(), nullptr, derivatives.data() );
		out = derivatives;
	}

	/// Within the joint limits, unlike OMPL's own. The tolerance is of the norm of all errors.
	bool project( Eigen::Ref<Eigen::VectorXd> x ) const override
	{
		Eigen::VectorXd q = x;
		const bool done = m_manifold->project( q.data(), 0.9 * getTolerance() / std::sqrt( m_manifold->rows() + 1.0 ) );
		x = q;
		return done;
	}

private:
	std::shared_ptr<Manifold> m_manifold;
};

} // namespace leeway::manifold
