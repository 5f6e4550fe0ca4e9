//! Everything about files that depends on the operating system, each with a portable default.
//!
//! | function | Linux | other Unix | elsewhere |
//! |---|---|---|---|
//! | [`exchange`] | atomic swap | none | none |
//! | [`sync_folder`] | flushes its entries | same | none |
//! | [`is_at`] | device and inode | same | the path exists: an open file cannot be removed |
//! | [`refuse_links`] | no link, no waiting for a pipe | same | none |
//! | [`has_other_names`] | count of hard links | same | none |
//! | [`foreign`] | owner and mode | same | none |
//! | [`private_folder`], [`user_file`] | mode | same | default |
//!
//! Tried on Linux only.

use std::fs::{DirBuilder, File, Metadata, OpenOptions};
use std::io::Result;
use std::path::Path;

/// Swaps two folders in one step; false if the system cannot, and nothing was done.
pub(super) fn exchange(one: &Path, other: &Path) -> Result<bool> {
    #[cfg(target_os = "linux")]
    {
        use rustix::fs::{CWD, RenameFlags, renameat_with};
        use rustix::io::Errno;
        match renameat_with(CWD, one, CWD, other, RenameFlags::EXCHANGE) {
            // Some network file systems lack this.
            Err(Errno::INVAL | Errno::NOSYS | Errno::NOTSUP) => Ok(false),
            done => Ok(done.map(|()| true)?),
        }
    }
    #[cfg(not(target_os = "linux"))]
    {
        let _ = (one, other);
        Ok(false)
    }
}

/// Flushes the entries of a folder, so that they survive a power cut. Only Unix can open a folder for that.
pub(super) fn sync_folder(folder: &Path) -> Result<()> {
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}

/// True if a path still leads to an open file.
pub(super) fn is_at(file: &File, path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let place = |metadata: Metadata| (metadata.dev(), metadata.ino());
        file.metadata().map(place).ok() == std::fs::symlink_metadata(path).map(place).ok()
    }
    #[cfg(not(unix))]
    {
        let _ = file;
        path.exists()
    }
}

/// Opens the path itself: neither the target of a link, nor a pipe that would wait for its other end.
pub(super) fn refuse_links(options: &mut OpenOptions) {
    #[cfg(unix)]
    {
        use rustix::fs::OFlags;
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags((OFlags::NOFOLLOW | OFlags::NONBLOCK | OFlags::NOCTTY).bits() as i32);
    }
    #[cfg(not(unix))]
    let _ = options;
}

/// True if a file has a second hard link.
pub(super) fn has_other_names(about: &Metadata) -> bool {
    #[cfg(unix)]
    {
        std::os::unix::fs::MetadataExt::nlink(about) > 1
    }
    #[cfg(not(unix))]
    {
        let _ = about;
        false
    }
}

/// Describes a folder that another user owns or may write; `None` for one of this user's.
///
/// * `beside` — folder in which a new folder shows the owner and mode of this user's: not every file system stores them
pub(super) fn foreign(about: &Metadata, beside: &Path) -> Result<Option<&'static str>> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, PermissionsExt};
        let mut builder = tempfile::Builder::new();
        builder.prefix(".").suffix(".tmp").permissions(std::fs::Permissions::from_mode(0o700));
        let own = builder.tempdir_in(beside)?.path().metadata()?;
        let written_by_others = |about: &Metadata| about.mode() & 0o022;
        Ok(match about {
            _ if about.uid() != own.uid() => Some("a folder of another user"),
            _ if written_by_others(about) & !written_by_others(&own) != 0 => {
                Some("a folder that others may write")
            }
            _ => None,
        })
    }
    #[cfg(not(unix))]
    {
        let _ = (about, beside);
        Ok(None)
    }
}

/// Creates folders that only this user may enter.
pub(super) fn private_folder() -> DirBuilder {
    #[cfg_attr(not(unix), expect(unused_mut))]
    let mut builder = DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder
}

/// Gives a temporary file the permissions of any file of this user.
pub(super) fn user_file(builder: &mut tempfile::Builder<'_, '_>) {
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    #[cfg(not(unix))]
    let _ = builder;
}
