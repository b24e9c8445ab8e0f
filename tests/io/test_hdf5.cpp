#include "io/hdf5.hpp"
#include "io/whole_file.hpp"
#include "io/xdmf.hpp"
#include "tests/folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <numeric>

using namespace taut;
using taut::test::Folder;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

namespace {

namespace fs = std::filesystem;
const MPI_Comm world = MPI_COMM_WORLD;

Slab my_slab(Global total) { return slab_of(total, size_of(world), rank_of(world)); }

/// All rows on one rank, none on the others.
Slab all_on(int rank, Global total) {
  const bool mine = rank_of(world) == rank;
  return {rank_of(world) > rank ? total : 0, mine ? total : 0, total};
}

template<class T>
std::vector<T> numbers_of(Slab rows, int columns) {
  std::vector<T> values(std::size_t(rows.count * columns));
  std::iota(values.begin(), values.end(), T(rows.first * columns));
  return values;
}

template<class T>
void round_trip(const fs::path& path, Slab written, Slab read, int columns) {
  write_whole(world, path, [&](H5Writer& file) {
    file.write<T>("/group/inner/data", numbers_of<T>(written, columns), columns, written);
  });
  const H5Reader file(world, path);
  EXPECT_EQ(file.rows("/group/inner/data"), written.total);
  EXPECT_EQ(file.columns("/group/inner/data"), columns);
  EXPECT_EQ(file.read<T>("/group/inner/data", read), numbers_of<T>(read, columns));
}

template<class Function>
std::string message_of(Function&& function) {
  try {
    function();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::string text_of(const fs::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

} // namespace

TEST(Hdf5, GivesBackWhatWasWritten) {
  const Folder folder;
  round_trip<double>(folder / "a.h5", my_slab(103), my_slab(103), 3);
  round_trip<std::int64_t>(folder / "b.h5", my_slab(103), my_slab(103), 2);
  round_trip<std::int32_t>(folder / "c.h5", my_slab(103), my_slab(103), 1);
}

TEST(Hdf5, AllowsEmptySlabs) {
  const Folder folder;
  const int last = size_of(world) - 1;
  round_trip<double>(folder / "a.h5", all_on(0, 7), all_on(last, 7), 3);
  round_trip<double>(folder / "b.h5", all_on(last, 7), all_on(0, 7), 1);
  round_trip<std::int64_t>(folder / "c.h5", my_slab(1), my_slab(1), 2);
  round_trip<double>(folder / "d.h5", my_slab(0), my_slab(0), 3);
}

TEST(Hdf5, ReadsOverlappingSlabs) {
  const Folder folder;
  round_trip<double>(folder / "a.h5", my_slab(40), Slab{3, 20, 40}, 3);
}

TEST(Hdf5, KeepsVectors) {
  const Folder folder;
  const Slab rows = my_slab(9);
  std::vector<Vec3> points;
  for (Global i = rows.first; i < rows.first + rows.count; ++i)
    points.emplace_back(double(i), 0.5, -double(i));
  write_whole(world, folder / "a.h5", [&](H5Writer& file) { file.write("/points", points, rows); });
  const H5Reader file(world, folder / "a.h5");
  EXPECT_EQ(file.columns("/points"), 3);
  EXPECT_EQ(file.read_vectors("/points", rows), points);
}

TEST(Hdf5, KeepsAttributes) {
  const Folder folder;
  const std::string long_text(100000, 'x');
  write_whole(world, folder / "a.h5", [&](H5Writer& file) {
    file.attribute("time", 0.1);
    file.attribute("step", Global(1) << 60);
    file.attribute("case", std::string("drape: größer"));
    file.attribute("long", long_text);
    file.attribute("empty", std::string());
  });
  const H5Reader file(world, folder / "a.h5");
  EXPECT_EQ(file.attribute<double>("time"), 0.1);
  EXPECT_EQ(file.attribute<std::int64_t>("step"), Global(1) << 60);
  EXPECT_EQ(file.attribute<std::string>("case"), "drape: größer");
  EXPECT_EQ(file.attribute<std::string>("long"), long_text);
  EXPECT_EQ(file.attribute<std::string>("empty"), "");
  EXPECT_THAT(message_of([&] { file.attribute<double>("case"); }),
              HasSubstr("attribute case cannot be read"));
  EXPECT_THAT(message_of([&] { file.attribute<double>("none"); }),
              HasSubstr("the file has no such attribute"));
}

TEST(Hdf5, KeepsTheAttributesOfRank0) {
  const Folder folder;
  const int rank = rank_of(world);
  write_whole(world, folder / "a.h5", [&](H5Writer& file) {
    for (int k = 0; k < 20; ++k)
      file.attribute("text_" + std::to_string(k), std::string(20 * (k + 1) + 30 * rank, char('a' + rank)));
    file.attribute("time", 0.1 + rank);
    file.attribute("step", Global(rank + 7));
  });
  const H5Reader file(world, folder / "a.h5");
  for (int k = 0; k < 20; ++k)
    EXPECT_EQ(file.attribute<std::string>("text_" + std::to_string(k)), std::string(20 * (k + 1), 'a'));
  EXPECT_EQ(file.attribute<double>("time"), 0.1);
  EXPECT_EQ(file.attribute<std::int64_t>("step"), 7);
}

// The clocks of ranks differ, and what is the same should be so to the bit.
TEST(Hdf5, KeepsNoTimes) {
  const Folder folder;
  write_whole(world, folder / "a.h5", [&](H5Writer& file) {
    const Slab rows = my_slab(8);
    file.write<double>("group/values", std::vector<double>(rows.count, 1.5), 1, rows);
  });
  const hid_t file = H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  for (const char* name : {"group", "group/values"}) {
    H5O_info_t info{};
    ASSERT_GE(H5Oget_info_by_name2(file, name, &info, H5O_INFO_TIME, H5P_DEFAULT), 0);
    EXPECT_EQ(info.ctime, 0) << name;
    EXPECT_EQ(info.mtime, 0) << name;
  }
  H5Fclose(file);
}

TEST(Hdf5, KnowsWhatIsThere) {
  const Folder folder;
  write_whole(world, folder / "a.h5", [&](H5Writer& file) {
    file.write<double>("/group/data", numbers_of<double>(my_slab(5), 1), 1, my_slab(5));
  });
  const H5Reader file(world, folder / "a.h5");
  EXPECT_TRUE(file.has("/group/data"));
  EXPECT_TRUE(file.has("/group"));
  EXPECT_FALSE(file.has("/group/other"));
  EXPECT_FALSE(file.has("/other/data"));
}

TEST(Hdf5, NamesFileAndDatasetInErrors) {
  const Folder folder;
  write_whole(world, folder / "a.h5", [&](H5Writer& file) {
    file.write<double>("/data", numbers_of<double>(my_slab(5), 1), 1, my_slab(5));
  });
  const H5Reader file(world, folder / "a.h5");
  EXPECT_THAT(message_of([&] { file.rows("/none/data"); }),
              AllOf(HasSubstr("a.h5: /none/data cannot be read"), HasSubstr("no such dataset")));
  EXPECT_THAT(message_of([&] { file.read<double>("/data", my_slab(6)); }), HasSubstr("5 rows instead of 6"));
  EXPECT_THAT(message_of([&] { file.read<Global>("/data", my_slab(5)); }),
              HasSubstr("does not hold integers"));
  EXPECT_THAT(message_of([&] { file.read_vectors("/data", my_slab(5)); }),
              HasSubstr("does not have 3 columns"));
}

TEST(Hdf5, RefusesWhatItCannotOpen) {
  const Folder folder;
  EXPECT_THAT(message_of([&] { H5Reader(world, folder / "none.h5"); }), HasSubstr("none.h5: no such file"));
  write_text_whole(world, folder / "text.h5", "not HDF5");
  EXPECT_THAT(message_of([&] { H5Reader(world, folder / "text.h5"); }),
              HasSubstr("text.h5: cannot be opened as HDF5"));
  EXPECT_THAT(message_of([&] { H5Writer(world, folder / "none/a.h5"); }),
              AllOf(HasSubstr("none/a.h5: cannot be written"), HasSubstr("No such file or directory")));
}

// Wherever a bit changes: in the values, in tables of HDF5, in attributes, in what nobody reads.
TEST(Checksum, TellsOfEveryChangedBit) {
  const Folder folder;
  const fs::path path = folder / "a.h5";
  const Slab rows = my_slab(40);
  write_whole(world, path, [&](H5Writer& file) {
    file.write<double>("/group/data", numbers_of<double>(rows, 3), 3, rows);
    file.attribute("text", std::string(300, 'x'));
  });
  EXPECT_EQ(damage_of(world, path, Checksum::required), "");
  std::string bytes = text_of(path);
  const std::size_t end = bytes.size() - std::strlen("taut crc32 89abcdef\n") - 1;
  for (std::size_t place = 0; place < bytes.size(); place += 37) {
    bytes[place] = char(bytes[place] ^ 1 << place % 8);
    write_text_whole(world, path, bytes, Outlives::program);
    EXPECT_THAT(damage_of(world, path, Checksum::required), HasSubstr("a.h5: ")) << place;
    if (place < end) {
      EXPECT_THAT(damage_of(world, path, Checksum::optional), HasSubstr("damaged")) << place;
    }
    bytes[place] = char(bytes[place] ^ 1 << place % 8);
  }
  write_text_whole(world, path, bytes.substr(0, end));
  EXPECT_THAT(damage_of(world, path, Checksum::required), HasSubstr("does not end with its checksum"));
  EXPECT_EQ(damage_of(world, path, Checksum::optional), "") << "as others write them";
  EXPECT_THAT(damage_of(world, folder / "none.h5", Checksum::optional), HasSubstr("none.h5: no such file"));
}

// CRC-32 has a check value: that of the digits from 1 to 9 is cbf43926.
TEST(Checksum, IsTheOneOfGzipOnAnyRanks) {
  const Folder folder;
  const fs::path path = folder / "a.txt";
  if (rank_of(world) == 0) begin_part(path, "123456789");
  append_checksum(world, path);
  if (rank_of(world) == 0) publish(path, Outlives::program);
  MPI_Barrier(world);
  EXPECT_EQ(text_of(path), "123456789\ntaut crc32 cbf43926\n");
}

TEST(WholeFile, LeavesTheOldFileWhenFillingFails) {
  const Folder folder;
  const fs::path path = folder / "a.h5";
  write_whole(world, path, [](H5Writer& file) { file.attribute("time", 1.0); });
  const auto fails = [&] {
    write_whole(world, path, [](H5Writer& file) {
      file.attribute("time", 2.0);
      throw InputError("stop");
    });
  };
  EXPECT_EQ(message_of(fails), "stop");
  EXPECT_EQ(folder.files(), 1u) << "the temporary is gone";
  EXPECT_EQ(H5Reader(world, path).attribute<double>("time"), 1.0);
  write_whole(world, path, [](H5Writer& file) { file.attribute("time", 3.0); });
  EXPECT_EQ(H5Reader(world, path).attribute<double>("time"), 3.0);
}

TEST(WholeFile, IsNotThereBeforeItIsWhole) {
  const Folder folder;
  const fs::path path = folder / "a.h5";
  write_whole(world, path, [&](H5Writer&) {
    EXPECT_FALSE(fs::exists(path));
    EXPECT_TRUE(fs::exists(part_of(path)));
    MPI_Barrier(world);
  });
  EXPECT_TRUE(fs::exists(path));
  EXPECT_EQ(folder.files(), 1u);
}

TEST(WholeFile, HasNoMoreThanItNeeds) {
  const Folder folder;
  const fs::path path = folder / "a.h5";
  write_whole(world, path, [](H5Writer& file) { file.attribute("time", 1.0); });
  EXPECT_LT(fs::file_size(path), 4096u) << "the room set aside while writing is given back";
}

TEST(WholeFile, ReplacesText) {
  const Folder folder;
  write_text_whole(world, folder / "a.txt", "a longer text");
  write_text_whole(world, folder / "a.txt", "short");
  EXPECT_EQ(text_of(folder / "a.txt"), "short");
  EXPECT_THAT(message_of([&] { write_text_whole(world, folder / "none/a.txt", "text"); }),
              AllOf(HasSubstr("none/a.txt: cannot be written"), HasSubstr("No such file or directory")));
  EXPECT_EQ(folder.files(), 1u);
}

TEST(WholeFile, MayOutliveTheProgramOnlyAndTheMachineLater) {
  const Folder folder;
  const auto fill = [](H5Writer& file) { file.attribute("time", 1.0); };
  write_whole(world, folder / "a.h5", fill, Outlives::program);
  write_text_whole(world, folder / "a.txt", "text", Outlives::program);
  make_lasting(world, std::vector<fs::path>{folder / "a.h5", folder / "taken-away.h5", folder / "a.txt"});
  EXPECT_EQ(H5Reader(world, folder / "a.h5").attribute<double>("time"), 1.0);
  EXPECT_EQ(text_of(folder / "a.txt"), "text");
  EXPECT_EQ(folder.files(), 2u);
}

TEST(Xdmf, MixesCells) {
  const std::vector<Global> vertices{7, 8, 0, 1, 2, 0, 1, 2, 3};
  EXPECT_THAT(xdmf_mixed_cells(vertices, std::vector<Global>{0, 2, 5, 9}),
              ElementsAre(2, 2, 7, 8, 4, 0, 1, 2, 5, 0, 1, 2, 3));
  EXPECT_THAT(xdmf_mixed_cells(std::span(vertices).subspan(2), std::vector<Global>{2, 5, 9}),
              ElementsAre(4, 0, 1, 2, 5, 0, 1, 2, 3));
  EXPECT_TRUE(xdmf_mixed_cells({}, std::vector<Global>{9}).empty());
}

TEST(Xdmf, DescribesEveryFrame) {
  XdmfDescription description;
  description.points = 9;
  description.cells = 4;
  description.cells_length = 16;
  description.fields = {
      {.name = "velocity", .dataset = "/velocities", .components = 3},
      {.name = "owner_rank", .dataset = "/owner_rank", .number = XdmfNumber::int32, .home = XdmfHome::mesh},
      {.name = "strain_warp", .dataset = "/cells/strain_warp", .centre = XdmfCentre::cell}};
  XdmfText frames(description);
  frames.add({0.0, "frames/frame_000000.h5"});
  frames.add({0.1, "frames/frame_000001.h5"});
  const std::string text = frames.whole();
  EXPECT_THAT(text, HasSubstr(R"(<Time Value="0.1"/>)"));
  EXPECT_THAT(text, HasSubstr(R"(Dimensions="4 4">mesh.h5:/faces<)"));
  EXPECT_THAT(text, HasSubstr(R"(Dimensions="9 3">frames/frame_000001.h5:/positions<)"));
  EXPECT_THAT(text, HasSubstr(R"(Dimensions="9 3">frames/frame_000001.h5:/velocities<)"));
  EXPECT_THAT(text, HasSubstr(R"(Precision="4" Dimensions="9">mesh.h5:/owner_rank<)"));
  EXPECT_THAT(text, HasSubstr(R"(AttributeType="Scalar" Center="Cell")"));
}

TEST(Xdmf, IsWellFormed) {
  XdmfDescription description;
  for (const auto shape : {XdmfCells::lines, XdmfCells::triangles, XdmfCells::quads, XdmfCells::mixed}) {
    description.shape = shape;
    description.fields = {{.name = "strain", .dataset = "/strain", .centre = XdmfCentre::cell}};
    XdmfText frames(description);
    for (const double time : {0.0, 0.5}) frames.add({time, "frames/f.h5"});
    const std::string text = frames.whole();
    std::vector<std::string> open; // every tag is closed by its own name, in the right order
    for (auto at = text.find('<'); at != std::string::npos; at = text.find('<', at + 1)) {
      const auto end = text.find('>', at);
      ASSERT_NE(end, std::string::npos);
      const std::string tag = text.substr(at + 1, end - at - 1);
      ASSERT_EQ(std::ranges::count(tag, '"') % 2, 0);
      if (tag.front() == '?' || tag.back() == '/') continue;
      if (tag.front() != '/') {
        open.push_back(tag.substr(0, tag.find(' ')));
      } else {
        ASSERT_FALSE(open.empty());
        EXPECT_EQ(open.back(), tag.substr(1));
        open.pop_back();
      }
    }
    EXPECT_TRUE(open.empty());
  }
}
