// netCDF files with damaged headers: each is read or refused with one message, and none ends the program.
#include <gtest/gtest.h>
#include <netcdf.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <sstream>

#include "protocol/units/operator_error.hpp"
#include "server/import/in_child.hpp"
#include "server/import/netcdf_file.hpp"
#include "server/import/netcdf_header.hpp"
#include "tests/unit/import/geotiff_writer.hpp"
#include "tests/unit/import/raster_writers.hpp"

namespace trochoid {
namespace {

using Format = NetcdfSpec::Format;

/// 6 x 5 samples with every kind of thing in the header.
NetcdfSpec small(Format format) {
    NetcdfSpec spec;
    spec.columns = 6;
    spec.rows = 5;
    spec.first_x = 2.0;
    spec.first_y = 43.0;
    spec.step_x = spec.step_y = 0.5;
    spec.height = [](double lon, double lat) { return lon * 100.0 - lat; };
    spec.format = format;
    spec.with_time = true;
    spec.positive = "up";
    spec.fill = -999.0;
    spec.also = "other";
    return spec;
}

std::string bytes_of(const std::filesystem::path& path) {
    std::ostringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    return bytes.str();
}

class NetcdfDamage : public testing::Test {
protected:
    std::string written(const NetcdfSpec& spec) {
        write_netcdf(folder_ / "whole.nc", spec);
        return bytes_of(folder_ / "whole.nc");
    }
    /// The message, or nothing where all samples are read.
    std::string outcome(const std::string& bytes) {
        const std::filesystem::path path = folder_ / "damaged.nc";
        // A new file each time: some file systems put one that is overwritten on the disk at once.
        std::filesystem::remove(path);
        std::ofstream(path, std::ios::binary) << bytes;
        return operator_error_of([&] {
            const std::unique_ptr<RasterFile> file = open_raster(path, "");
            const RasterPlacement& p = file->placement();
            ASSERT_EQ(file->read(0, 0, p.columns, p.rows, {}).size(),
                      static_cast<std::size_t>(p.columns * p.rows));
        });
    }
    ScratchFolder folder_;
};

/// Header's end: where the first variable's values begin.
std::size_t header_bytes(const std::string& bytes) {
    // 64-bit coordinate 2.0 is the first value of `lon`, the first variable.
    const std::string two("\x40\0\0\0\0\0\0\0", 8);
    const std::size_t at = bytes.find(two + std::string("\x40\x04\0\0\0\0\0\0", 8));
    return at == std::string::npos ? 0 : at;
}

TEST_F(NetcdfDamage, EveryByteOfAClassicHeader) {
    for (const Format format : {Format::classic, Format::offset_64, Format::data_64}) {
        const std::string whole = written(small(format));
        ASSERT_EQ(outcome(whole), "") << int(format);
        const std::size_t header = header_bytes(whole);
        ASSERT_GT(header, 300U);
        std::size_t read = 0, refused = 0;
        for (std::size_t at = 0; at < header; ++at)
            for (const unsigned flip : {0x01U, 0x10U, 0x80U, 0xffU}) {
                std::string damaged = whole;
                damaged[at] = static_cast<char>(static_cast<unsigned char>(damaged[at]) ^ flip);
                (outcome(damaged).empty() ? read : refused) += 1;
            }
        // Texts may change without harm, and sizes that the library works out itself; the rest may not.
        EXPECT_GT(refused, header) << int(format);
        EXPECT_GT(read, 0U) << int(format);
    }
}

TEST_F(NetcdfDamage, EveryFieldOfAClassicHeader) {
    for (const Format format : {Format::classic, Format::offset_64, Format::data_64}) {
        const std::string whole = written(small(format));
        const std::size_t header = header_bytes(whole);
        const std::size_t wide = format == Format::data_64 ? 8 : 4;
        for (std::size_t at = 4; at + wide <= header; at += 4)
            for (const std::string& value :
                 {std::string("\0\0\0\0\0\0\0\0", 8), std::string("\xff\xff\xff\xff\xff\xff\xff\xff"),
                  std::string("\x7f\xff\xff\xff\xff\xff\xff\xff"), std::string("\x10\0\0\0\0\0\0\0", 8),
                  std::string("\0\x10\0\0\0\x10\0\0", 8), std::string("\0\0\0\x0b\0\0\0\x0b", 8)}) {
                std::string damaged = whole;
                damaged.replace(at, wide, value.substr(0, wide));
                outcome(damaged);
            }
    }
}

TEST_F(NetcdfDamage, EveryLengthOfAClassicFileIsRefused) {
    for (const Format format : {Format::classic, Format::offset_64, Format::data_64}) {
        const std::string whole = written(small(format));
        for (std::size_t length = 0; length + 3 < whole.size(); ++length)
            ASSERT_NE(outcome(whole.substr(0, length)), "") << int(format) << ' ' << length;
    }
}

/// The messages name what is wrong, so they come from our own look at the header.
TEST_F(NetcdfDamage, MessagesSayWhatIsDamaged) {
    const std::string whole = written(small(Format::classic));
    const auto with = [&](std::size_t at, const std::string& value) {
        std::string damaged = whole;
        damaged.replace(at, value.size(), value);
        return outcome(damaged);
    };
    const auto says = [](const std::string& text, const char* part) {
        return text.find(part) != std::string::npos;
    };
    EXPECT_TRUE(says(with(3, "\3"), "version 3")) << with(3, "\3");
    EXPECT_TRUE(says(with(4, "\xff\xff\xff\xff"), "as a stream"));
    EXPECT_TRUE(says(with(8, std::string("\0\0\0\x09", 4)), "a list begins with 9"));
    // More dimensions than the file has bytes.
    EXPECT_TRUE(says(with(12, "\x7f\xff\xff\xff"), "damaged"));
    EXPECT_TRUE(says(with(16, std::string("\0\1\0\0", 4)), "a name of 65536 bytes"));
    EXPECT_TRUE(says(with(20, std::string("\0", 1)), "a name that is no text"));
    // The length of `time`, then of `lat`: 5 becomes 16 million.
    EXPECT_TRUE(says(with(24, std::string("\0\0\0\0", 4)), "")) << "time becomes the records";
    EXPECT_TRUE(says(with(36, std::string("\1", 1)), "thousands of such files")) << with(36, "\1");
    EXPECT_TRUE(says(outcome(whole.substr(0, whole.size() - 8)), "the file is cut short ("));
}

/// Records: a variable over the unlimited dimension takes as much as there are records.
TEST_F(NetcdfDamage, RecordsAreCounted) {
    const std::filesystem::path path = folder_ / "records.nc";
    int file = -1, time = -1, variable = -1;
    ASSERT_EQ(nc_create(path.c_str(), NC_CLOBBER, &file), NC_NOERR);
    ASSERT_EQ(nc_def_dim(file, "time", NC_UNLIMITED, &time), NC_NOERR);
    ASSERT_EQ(nc_def_var(file, "t", NC_SHORT, 1, &time, &variable), NC_NOERR);
    ASSERT_EQ(nc_enddef(file), NC_NOERR);
    const std::vector<short> values(1001, 7);
    const std::size_t start = 0, count = values.size();
    ASSERT_EQ(nc_put_vara_short(file, variable, &start, &count, values.data()), NC_NOERR);
    ASSERT_EQ(nc_close(file), NC_NOERR);
    const auto message = [&] { return operator_error_of([&] { check_netcdf_header(path); }); };
    EXPECT_EQ(message(), "");
    const std::string whole = bytes_of(path);
    std::ofstream(path, std::ios::binary) << whole.substr(0, whole.size() - 100);
    EXPECT_NE(message().find("cut short"), std::string::npos) << message();
    std::string more = whole;
    more[5] = 1;
    std::ofstream(path, std::ios::binary) << more;
    EXPECT_NE(message().find("cut short"), std::string::npos) << message();
}

TEST_F(NetcdfDamage, ADeathInTheChildIsAnErrorOfTheOperators) {
    EXPECT_EQ(in_child("x.nc", [] { return 0; }), 0);
    EXPECT_EQ(in_child("x.nc", [] { return 2; }), 2);
    const auto dies = [](int signal) {
        return operator_error_of([&] {
            in_child("x.nc", [&] {
                std::signal(signal, SIG_DFL);
                std::raise(signal);
                return 0;
            });
        });
    };
    EXPECT_EQ(
        dies(SIGSEGV),
        "x.nc: the library that reads it died of it (signal 11): the file is damaged: fetch it again, or "
        "convert it with gdal_translate -of GTiff");
    EXPECT_NE(dies(SIGKILL).find("memory"), std::string::npos);
}

/// The program, on netCDF-4 files, whose headers we do not know: it succeeds or says one sentence, whatever HDF5 does.
TEST_F(NetcdfDamage, TheProgramSurvivesDamagedNetcdf4) {
    const std::string whole = written(small(Format::netcdf4));
    const std::string command =
        std::string("'") + TROCHOID_BIN_DIR + "/trochoid-import' raster '" +
        (folder_ / "damaged.nc").string() + "' --out '" + (folder_ / "out.terrain").string() +
        "' --origin 3,44 --extent 64000,64000 --spacing 4096 > '" + (folder_ / "said").string() + "' 2>&1";
    for (std::size_t at = 8; at < std::min<std::size_t>(whole.size(), 6000); at += 131) {
        std::string damaged = whole;
        damaged[at] = static_cast<char>(static_cast<unsigned char>(damaged[at]) ^ 0xffU);
        std::filesystem::remove(folder_ / "damaged.nc");
        std::ofstream(folder_ / "damaged.nc", std::ios::binary) << damaged;
        // NOLINTNEXTLINE(concurrency-mt-unsafe): a test has one thread here.
        const int status = std::system(command.c_str());
        ASSERT_TRUE(WIFEXITED(status));
        const int code = WEXITSTATUS(status);
        ASSERT_TRUE(code == 0 || code == 2) << at << ": " << bytes_of(folder_ / "said");
    }
}

}  // namespace
}  // namespace trochoid
