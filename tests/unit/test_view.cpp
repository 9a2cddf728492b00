// Some versions of Kokkos and g++ 12 together break a View that was constructed without memory:
// its reference count is a null record. Every class of the kernels holds such Views for a moment.
#include <Kokkos_Core.hpp>
#include <gtest/gtest.h>

#include <vector>

namespace ricochet::test {
namespace {

using View = Kokkos::View<double*>;

struct Holder {
  View view;
  int count = 0;
};

TEST(DefaultView, HasNoLabelNoMemoryAndNoOwner)
{
  View const view;
  EXPECT_EQ(view.label(), "");
  EXPECT_EQ(view.extent(0), 0u);
  EXPECT_EQ(view.use_count(), 0);
}

TEST(DefaultView, CanBeAssigned)
{
  View view;
  view = View("ricochet::assigned", 3);
  EXPECT_EQ(view.extent(0), 3u);
  EXPECT_EQ(view.use_count(), 1);
  view = View();
  EXPECT_EQ(view.extent(0), 0u);
}

TEST(DefaultView, CanBeResized)
{
  View view;
  Kokkos::resize(view, 4);
  EXPECT_EQ(view.extent(0), 4u);
}

TEST(DefaultView, CanBeCopiedAndMoved)
{
  View view;
  View copy = view;
  View const moved = std::move(view);
  copy = moved;
  EXPECT_EQ(copy.use_count(), 0);
}

TEST(DefaultView, CanBeKeptInAStructAndAVector)
{
  std::vector<Holder> holders(3);
  holders[1].view = View("ricochet::held", 2);
  holders.resize(50);
  holders.erase(holders.begin());
  EXPECT_EQ(holders[0].view.extent(0), 2u);
  EXPECT_EQ(holders[0].view.use_count(), 1);
  EXPECT_EQ(holders[20].view.label(), "");
}

} // namespace
} // namespace ricochet::test
