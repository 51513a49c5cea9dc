#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace controlspace {

/// A folder of its own for a test's pictures, removed at the end.
class PictureFolder {
public:
    explicit PictureFolder(const std::string& name)
        : path_(std::filesystem::temp_directory_path() / ("controlspace-report-" + name)) {
        std::filesystem::remove_all(path_);
        std::filesystem::create_directories(path_);
    }
    ~PictureFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    PictureFolder(const PictureFolder&) = delete;
    PictureFolder& operator=(const PictureFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }

    /// Of the files in it, sorted.
    std::vector<std::string> names() const {
        std::vector<std::string> names;
        for (const auto& file : std::filesystem::directory_iterator(path_)) {
            names.push_back(file.path().filename().string());
        }
        std::sort(names.begin(), names.end());
        return names;
    }

private:
    std::filesystem::path path_;
};

}  // namespace controlspace
