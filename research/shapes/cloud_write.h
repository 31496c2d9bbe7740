#pragma once

#include "batten/cloud_file.h"
#include "io/common/block_writer.h"

/// Write a cloud that passes bat_cloud_check().
bat_status cloud_write(const bat_cloud *cloud, bat_cloud_format format, text_sink *sink, bat_error *error);
