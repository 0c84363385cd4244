//! The cards and colours of a fabric's yarns, and which of them are several that run together.

use std::collections::{BTreeMap, BTreeSet};

use super::base::Base;
use super::yarn;
use crate::model::{Member, YarnCard, Yarns};
use crate::scene::error::{Complaint, nearest, shortened};
use crate::scene::schema::YarnText;

/// What is known of the yarns of a fabric.
pub(super) struct YarnCards<'a> {
    /// Names that the chart or the weave gives its yarns, in their order.
    pub names: &'a [String],
    /// Those of them that a chart's file makes of several: their members by name.
    pub together: &'a BTreeMap<String, Vec<String>>,
    /// The scene's yarn.
    pub first: &'a YarnText,
    /// What stands behind it.
    pub base: &'a Base,
    /// The other yarns' tables by name.
    pub others: &'a BTreeMap<String, YarnText>,
}

type Resolved = (YarnCard, [u8; 3]);

impl YarnCards<'_> {
    /// The cards and colours by number: what yarns have of their own, over what the scene's yarn says.
    pub fn resolve(&self) -> Result<(Yarns, Vec<[u8; 3]>), Complaint> {
        self.check_names()?;
        let own = yarn::resolve("yarn", self.first, &self.base.yarn)?;
        let members = self.names.iter().map(|name| self.members(name)).collect::<Result<Vec<_>, _>>()?;
        let of = |(name, members): (&String, &Vec<Member>)| self.of(name, members);
        let found = self.names.iter().zip(&members).map(of).collect::<Result<Vec<_>, _>>()?;
        let (mut cards, colors): (Vec<_>, Vec<_>) =
            if found.is_empty() { vec![own] } else { found }.into_iter().unzip();
        let yarns = Yarns::new(cards.remove(0), cards);
        Ok((yarns.named(self.names.iter().map(|name| self.title(name)).collect(), members), colors))
    }

    /// Every table is that of a yarn of the fabric, or of one that runs together with others in such a one.
    fn check_names(&self) -> Result<(), Complaint> {
        for (key, given) in [("name", self.first.name.is_some()), ("together", self.first.together.is_some())] {
            if given {
                return Err(Complaint::new(format!("yarn.{key}"), format!("{key} of the scene's own yarn"))
                    .why("only a yarn that the chart or the weave names has it")
                    .mend("name one there, as in stripes = [\"P\"], and write it under [yarns.P]"));
            }
        }
        let members = self.names.iter().filter_map(|name| self.member_names(name)).flatten();
        let known: BTreeSet<&str> = self.names.iter().chain(members).map(String::as_str).collect();
        let Some(other) = self.others.keys().find(|other| !known.contains(other.as_str())) else { return Ok(()) };
        let what = format!("the fabric has no yarn \"{}\"", shortened(other));
        let mend = nearest(other, known).map(|near| format!("did you mean \"{near}\"?"));
        Err(Complaint::new(format!("yarns.{other}"), what).mend(mend.unwrap_or_else(|| {
            "name it in stripes, yarns, palette, warp, weft, together or the chart's file, or leave it out".to_owned()
        })))
    }

    /// What a yarn is called.
    fn title(&self, name: &str) -> String {
        self.others.get(name).and_then(|text| text.name.clone()).unwrap_or_else(|| name.to_owned())
    }

    /// The yarns that run together as one: what the scene says goes before what the chart's file says.
    fn member_names(&self, name: &str) -> Option<&Vec<String>> {
        self.others.get(name).and_then(|text| text.together.as_ref()).or_else(|| self.together.get(name))
    }

    fn members(&self, name: &str) -> Result<Vec<Member>, Complaint> {
        let Some(names) = self.member_names(name) else { return Ok(Vec::new()) };
        let complain = |what: String| Complaint::new(format!("yarns.{name}.together"), what);
        if names.len() < 2 {
            return Err(complain(format!("\"{}\" is together with nothing", shortened(name)))
                .mend("name two yarns or more; the same twice is a yarn held double"));
        }
        let said_here = self.others.get(name).is_some_and(|text| text.together.is_some());
        let one = |of: &String| {
            if of == name {
                return Err(complain(format!("\"{}\" cannot be a part of itself", shortened(of)))
                    .mend("name the yarns that run together as it"));
            }
            if self.member_names(of).is_some() {
                let complaint = complain(format!("\"{}\" is several yarns itself", shortened(of)));
                return Err(complaint.mend("name those in its place"));
            }
            // Carriers and yarns of instructions need no table.
            if said_here && !self.others.contains_key(of) && !self.names.contains(of) {
                let near = nearest(of, self.others.keys().chain(self.names).map(String::as_str));
                let near = near.filter(|near| *near != name).map(|near| format!("did you mean \"{near}\"? or "));
                let mend = format!("{}add a table [yarns.{}]", near.unwrap_or_default(), shortened(of));
                return Err(complain(format!("there is no yarn \"{}\"", shortened(of))).mend(mend));
            }
            let (card, color) = self.single(of)?;
            Ok(Member { name: self.title(of), color, card })
        };
        names.iter().map(one).collect()
    }

    fn single(&self, name: &str) -> Result<Resolved, Complaint> {
        let path = format!("yarns.{name}");
        let behind = yarn::said_over_base(self.first, &self.base.yarn);
        match (self.others.get(name), self.base.yarns.get(name)) {
            (Some(other), known) => {
                of_the_first(&path, other)?;
                let behind = known.map_or_else(|| behind.clone(), |known| yarn::said_over_base(known, &behind));
                yarn::resolve(&path, other, &behind)
            }
            (None, Some(known)) => yarn::resolve(&path, &yarn::said_over_base(self.first, known), &self.base.yarn),
            (None, None) => yarn::resolve("yarn", self.first, &self.base.yarn),
        }
    }

    /// A yarn of the fabric. One of several: what it says of its own, over what follows from them; the first is the one that is
    /// seen.
    fn of(&self, name: &str, members: &[Member]) -> Result<Resolved, Complaint> {
        let [seen, beside @ ..] = members else { return self.single(name) };
        let path = format!("yarns.{name}");
        let card = YarnCard::together(&seen.card, beside.iter().map(|member| &member.card));
        let derived = yarn::text_of(&card, seen.color).map_err(|what| Complaint::new(path.as_str(), what))?;
        let said = self.others.get(name).cloned().unwrap_or_default();
        of_the_first(&path, &said)?;
        yarn::resolve(&path, &said, &derived)
    }
}

/// What only the scene's first yarn says.
fn of_the_first(path: &str, text: &YarnText) -> Result<(), Complaint> {
    let keys = [
        ("preset", text.preset.is_some()),
        ("card", text.card.is_some()),
        ("mass_damping", text.mass_damping.is_some()),
        ("stiffness_damping", text.stiffness_damping.is_some()),
    ];
    match keys.iter().find(|(_, given)| *given) {
        Some((key, _)) => Err(Complaint::new(format!("{path}.{key}"), format!("{key} of one yarn among others"))
            .why("it is that of the whole fabric")
            .mend(format!("give {key} in [yarn]"))),
        None => Ok(()),
    }
}
