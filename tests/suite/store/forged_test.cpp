// Files altered behind checksums that are right: what contradicts another file
// is named, and so are numbers, types and shapes that cannot be.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "suite/results/results.h"
#include "suite/store/store.h"
#include "tests/suite/store/store_testing.h"

namespace physinv {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class ForgedTest : public testing::Test {
 protected:
  ForgedTest() {
    Store store(directory_.path());
    store.set_plan({info_}, {{"date", "today"}, {"host_name", "here"}});
    for (Index k = 0; k < 2; ++k)
      store.append(info_, sample_data(info_), sample_stage(info_, k));
    store.finish();
    bytes_ = read_file(path_);
  }

  /// The message when `change` was made to the case's file, with a good
  /// trailer.
  template <class F>
  std::string after(F&& change) {
    auto file = hdf5::open_image(bytes_.substr(0, bytes_.size() - 16));
    change(file);
    std::string image = hdf5::image(file);
    image += fmt::format("physinv:{:08x}", crc32c(image));
    write_file(path_, image);
    const auto message =
        message_of<StoreError>([&] { load_results(directory_.path()); });
    EXPECT_TRUE(contains(message, path_.filename().string())) << message;
    EXPECT_FALSE(contains(message, "\n"));
    return message;
  }

  /// The same with other numbers in an array.
  template <class F>
  std::string after(const std::string& array, F&& change) {
    return after([&](hid_t file) {
      const int rank = hdf5::rank(file, array);
      Batch<double> numbers;
      if (rank == 1) {
        const auto list = hdf5::read_list(file, array);
        numbers = Eigen::Map<const Batch<double>>(
            list.data(), static_cast<Index>(list.size()), 1);
      } else {
        numbers = rank == 2 ? hdf5::read_batch(file, array)
                            : hdf5::read_cube(file, array);
      }
      change(numbers);
      hdf5::remove(file, array);
      if (rank == 1) {
        hdf5::write(
            file,
            array,
            std::vector(numbers.data(), numbers.data() + numbers.size()));
      } else {
        rank == 2 ? hdf5::write(file, array, numbers)
                  : hdf5::write_cube(file, array, numbers, 1);
      }
    });
  }

  TemporaryDirectory directory_;
  CaseInfo info_ = sample_case("jpo", 3, 7);
  std::filesystem::path path_ =
      directory_ / "cases" / case_file_name(info_.name);
  std::string bytes_;
};

TEST_F(ForgedTest, EveryNumberOfTheDataCounts) {
  for (const char* array : {"data/x", "data/y"})
    for (Index i = 0; i < 6; ++i)
      EXPECT_TRUE(contains(
          after(array,
                [&](auto& b) { b.data()[i] = std::nextafter(b.data()[i], 9); }),
          "the hash of the data arrays is wrong"));
}

TEST_F(ForgedTest, EveryNumberOfAStageCounts) {
  for (const char* array : {"x",
                            "loss",
                            "iterations",
                            "curve/loss",
                            "curve/x",
                            "arrays/parameters"})
    EXPECT_TRUE(contains(after(fmt::format("stages/0_fit/{}", array),
                               [](auto& b) { b.data()[b.size() - 1] += 1; }),
                         "differs from its journal line"));
}

TEST_F(ForgedTest, DataAreFinite) {
  EXPECT_TRUE(contains(after("data/x", [](auto& b) { b(1, 2) = kNan; }),
                       "array data/x contains values that are not finite"));
}

TEST_F(ForgedTest, TypesAndShapesAreNamed) {
  EXPECT_TRUE(contains(after("data/x", [](auto& b) { b.transposeInPlace(); }),
                       "array data/x has the shape 2 x 3"));
  EXPECT_TRUE(
      contains(after("stages/0_fit/iterations",
                     [](auto& b) { b.conservativeResize(2, 1); }),
               "array stages/0_fit/iterations has 2 entries; expected 3"));
  const auto with_type = [&](const std::string& array, hid_t type, int rank) {
    return after([&](hid_t file) {
      hdf5::remove(file, array);
      const hsize_t shape[] = {3, 2, 1, 1};
      const hdf5::Handle space(
          H5Screate_simple(rank, shape, nullptr), H5Sclose, "make a shape");
      const hdf5::Handle set(H5Dcreate2(file,
                                        array.c_str(),
                                        type,
                                        space,
                                        H5P_DEFAULT,
                                        H5P_DEFAULT,
                                        H5P_DEFAULT),
                             H5Dclose,
                             "create an array");
    });
  };
  for (const char* array : {"data/x", "data/y", "stages/0_fit/x"}) {
    EXPECT_TRUE(contains(with_type(array, H5T_IEEE_F32LE, 2),
                         fmt::format("{}: a type of numbers", array)));
    EXPECT_TRUE(contains(with_type(array, H5T_STD_I64LE, 2),
                         fmt::format("{}: a type of numbers", array)));
    EXPECT_TRUE(contains(after([&](hid_t file) {
                           hdf5::remove(file, array);
                           hdf5::write_cube(
                               file, array, sample_batch(2, 3, 0), 1);
                         }),
                         "does not have 2 dimensions"));
    EXPECT_TRUE(contains(with_type(array, H5T_IEEE_F64LE, 4),
                         fmt::format("{}: a shape", array)));
    EXPECT_TRUE(
        contains(after([&](hid_t file) { hdf5::remove(file, array); }), "x"));
  }
}

/// What may be no number is a matter of how the stage ended.
TEST_F(ForgedTest, NumbersAreFiniteWhereTheyMustBe) {
  const auto message = [&](Stop stop, auto&& change) -> std::string {
    StageRecord r = sample_stage(info_, 0);
    r.stop = stop;
    if (stop == Stop::converged) r.loss.setOnes();
    change(r);
    CaseFile file(info_.name);
    const std::string hash = hex64(arrays_hash(r));
    file.put_stage(r, hash);
    try {
      file.read_stage(r, hash);
    } catch (const StoreError& error) {
      return error.what();
    }
    return "";
  };
  const auto none = [](StageRecord&) {};
  const auto loss = [](StageRecord& r) { r.loss(2) = kNan; };
  const auto x = [](StageRecord& r) { r.loss(2) = 1, r.x(0, 2) = kNan; };
  const auto work = [](StageRecord& r) { r.example_evaluations(0) = -1; };
  const auto time = [](StageRecord& r) { r.curve.seconds[1] = kNan; };
  for (const Stop stop : {Stop::converged, Stop::iterations, Stop::diverged}) {
    EXPECT_EQ(message(stop, none), "");
    EXPECT_TRUE(contains(message(stop, work), "0_fit/evaluations"));
    EXPECT_TRUE(contains(message(stop, time), "0_fit/curve/seconds"));
  }
  EXPECT_TRUE(contains(message(Stop::converged, loss), "0_fit/loss"));
  EXPECT_EQ(message(Stop::iterations, loss), "");
  EXPECT_TRUE(contains(message(Stop::iterations, x), "0_fit/x"));
  EXPECT_EQ(message(Stop::diverged, x), "");
}

TEST_F(ForgedTest, DataOfAnotherSeedAreNamed) {
  CaseFile file(info_.name);
  file.put_data(sample_data(sample_case("jpo", 3, 8)));
  for (Index k = 0; k < 2; ++k) {
    const auto stage = sample_stage(info_, k);
    file.put_stage(stage, hex64(arrays_hash(stage)));
  }
  file.save(Folder(directory_ / "cases"));
  EXPECT_TRUE(
      contains(message_of<StoreError>([&] { load_results(directory_.path()); }),
               "its data differ from the journal line"));
}

}  // namespace
}  // namespace physinv
