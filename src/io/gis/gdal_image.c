#include "base/memory.h"
#include "io/gis/gdal.h"
#include "io/gis/gis.h"

/// @file
/// Images by GDAL.

/// Read the pixels of an open image.
static bat_status read_pixels(GDALDatasetH set, const gdal_messages *messages, bat_mesh_image *image, bat_error *error)
{
    int width = gdal.GDALGetRasterXSize(set), height = gdal.GDALGetRasterYSize(set), bands = gdal.GDALGetRasterCount(set),
        order[3] = {1, bands < 3 ? 1 : 2, bands < 3 ? 1 : 3};
    GDALRasterBandH first = bands > 0 ? gdal.GDALGetRasterBand(set, 1) : NULL;
    if (first == NULL || gdal.GDALGetRasterDataType(first) != GDT_Byte || gdal.GDALGetRasterColorTable(first) != NULL)
        return ERROR_UNSUPPORTED(error, 0, "it has not 8 bits a channel, or a palette");
    if ((double)width * (double)height > IMAGE_MAX_PIXELS)
        return ERROR_TOO_LARGE(error, "its %d x %d pixels are more than %d", width, height, IMAGE_MAX_PIXELS);
    bat_mesh_image made = {memory_array((size_t)width * (size_t)height, 3), (size_t)width, (size_t)height};
    if (made.pixels == NULL)
        return error_memory(error, 3 * (size_t)width * (size_t)height);
    bool read = gdal.GDALDatasetRasterIO(set, GF_Read, 0, 0, width, height, made.pixels, width, height, GDT_Byte, 3, order,
                                         3, 3 * width, 1) == CE_None;
    if (read)
        SWAP(*image, made);
    free(made.pixels);
    return read ? BAT_OK : gdal_fault(messages, BAT_BAD_FILE, error, "its pixels cannot be read");
}

bat_status gis_image_read(const void *bytes, size_t size, bat_mesh_image *image, bat_error *error)
{
    static const char *const drivers[] = {"JPEG", "PNG", "WEBP", "GTiff", "BMP", NULL};
    static const char strict[] = "GDAL_ERROR_ON_LIBJPEG_WARNING"; // without it the rest of a cut file is grey
    gdal_messages messages;
    char name[48];
    if (gdal_begin(&messages, error) != BAT_OK)
        return BAT_UNSUPPORTED;
    (void)snprintf(name, sizeof name, "/vsimem/batten-%p", bytes);
    gdal.CPLSetThreadLocalConfigOption(strict, "TRUE");
    VSILFILE *file = gdal.VSIFileFromMemBuffer(name, (GByte *)(uintptr_t)bytes, size, FALSE); // GDAL does not write to it
    GDALDatasetH set = file != NULL ? gdal.GDALOpenEx(name, GDAL_OF_RASTER, drivers, NULL, NULL) : NULL;
    bat_status status = set != NULL ? read_pixels(set, &messages, image, error)
                                    : gdal_fault(&messages, BAT_BAD_FILE, error, "it is no image that GDAL knows");
    gdal.GDALClose(set);
    if (file != NULL)
        (void)gdal.VSIFCloseL(file);
    (void)gdal.VSIUnlink(name);
    gdal.CPLSetThreadLocalConfigOption(strict, NULL);
    gdal_end();
    return status;
}
