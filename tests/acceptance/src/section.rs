//! Groups of sections, and which of them the command line asks for.

use crate::table::Table;

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub enum Extent {
    /// A few minutes in all.
    Quick,
    /// All sections but those that run by name only.
    Usual,
    /// The same, with more layouts and longer runs.
    Full,
}

/// When a section runs that is not named itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum When {
    /// Always.
    Quick,
    /// Not with `--quick`.
    Usual,
    /// Never: it takes very long, or writes a file of the repository.
    Named,
}

/// Figures that are measured together.
pub struct Section {
    /// Name, unique within its group.
    pub name: &'static str,
    /// When it runs.
    pub when: When,
    /// Measures the figures.
    pub run: fn(&mut Table),
}

/// Section of the quick part.
pub const fn quick(name: &'static str, run: fn(&mut Table)) -> Section {
    Section { name, when: When::Quick, run }
}

/// Section that takes minutes.
pub const fn usual(name: &'static str, run: fn(&mut Table)) -> Section {
    Section { name, when: When::Usual, run }
}

/// Section that runs by name only.
pub const fn named(name: &'static str, run: fn(&mut Table)) -> Section {
    Section { name, when: When::Named, run }
}

/// Sections about one subject.
pub struct Group {
    /// Name on the command line.
    pub name: &'static str,
    /// Subject, in one line.
    pub title: &'static str,
    /// Sections in the order in which they run.
    pub sections: &'static [Section],
}

/// Groups with the sections of them that run. A name is that of a group, of one section as
/// GROUP/SECTION, or of all sections that are called so; without names all groups run.
///
/// # Errors
///
/// A name that no group and no section has.
pub fn select<'a>(
    groups: &'a [Group],
    names: &[String],
    extent: Extent,
) -> Result<Vec<(&'a Group, Vec<&'a Section>)>, String> {
    let is_group = |name: &str| groups.iter().any(|group| group.name == name);
    for name in names {
        let known = |group: &Group| group.sections.iter().any(|s| is_named(name, group, s));
        if !is_group(name) && !groups.iter().any(known) {
            return Err(format!("{name}: no such group or section; --list prints all"));
        }
    }
    let chosen = |group: &Group, section: &Section| {
        let by_name = |name: &String| !is_group(name) && is_named(name, group, section);
        let by_group = names.is_empty() || names.iter().any(|name| name == group.name);
        let due = match section.when {
            When::Quick => true,
            When::Usual => extent >= Extent::Usual,
            When::Named => false,
        };
        names.iter().any(by_name) || (by_group && due)
    };
    let of = |group: &'a Group| {
        let sections = group.sections.iter().filter(|section| chosen(group, section)).collect();
        (group, sections)
    };
    Ok(groups.iter().map(of).filter(|(_, sections): &(_, Vec<_>)| !sections.is_empty()).collect())
}

fn is_named(name: &str, group: &Group, section: &Section) -> bool {
    match name.split_once('/') {
        Some((of, name)) => of == group.name && name == section.name,
        None => name == section.name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GROUPS: [Group; 2] = [
        Group {
            name: "flyer",
            title: "",
            sections: &[quick("bits", |_| ()), usual("speed", |_| ()), named("long", |_| ())],
        },
        Group {
            name: "plane",
            title: "",
            sections: &[usual("bits", |_| ()), quick("flyer", |_| ())],
        },
    ];

    fn selected(names: &[&str], extent: Extent) -> Vec<String> {
        let names: Vec<String> = names.iter().map(|name| name.to_string()).collect();
        let groups = select(&GROUPS, &names, extent).unwrap();
        let full = |(group, sections): &(&Group, Vec<&Section>)| -> Vec<String> {
            sections.iter().map(|s| format!("{}/{}", group.name, s.name)).collect()
        };
        groups.iter().flat_map(full).collect()
    }

    #[test]
    fn sections_are_chosen_by_extent_unless_they_are_named() {
        let usual = ["flyer/bits", "flyer/speed", "plane/bits", "plane/flyer"];
        assert_eq!(selected(&[], Extent::Usual), usual);
        assert_eq!(selected(&[], Extent::Quick), ["flyer/bits", "plane/flyer"]);
        assert_eq!(selected(&["flyer"], Extent::Quick), ["flyer/bits"]);
        assert_eq!(selected(&["long"], Extent::Quick), ["flyer/long"]);
        assert_eq!(selected(&["bits"], Extent::Quick), ["flyer/bits", "plane/bits"]);
        assert_eq!(selected(&["plane/bits"], Extent::Quick), ["plane/bits"]);
        assert_eq!(
            selected(&["plane/flyer", "long"], Extent::Usual),
            ["flyer/long", "plane/flyer"]
        );
    }

    #[test]
    fn an_unknown_name_is_refused() {
        for name in ["flier", "plane/speed", "flyer/"] {
            let refused = select(&GROUPS, &[name.to_string()], Extent::Usual);
            assert!(refused.is_err_and(|message| message.contains(name)));
        }
    }
}
