(* The rates of the laws are continuous in all their arguments, where the level may vary too. *)
From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Stribeck Require Import Laws Motion Terms.
Open Scope R_scope.

(* The law's constants with another level. *)
Definition at_level (p : constants) (Fc Fs : R) : constants :=
  {| sigma_0 := sigma_0 p; sigma_1 := sigma_1 p; sigma_2 := sigma_2 p; F_c := Fc; F_s := Fs; v_s := v_s p;
     v_d := v_d p; k_v := k_v p; z_ba := z_ba p |}.

Lemma at_own_level p : at_level p (F_c p) (F_s p) = p.
Proof. destruct p; reflexivity. Qed.

Lemma continuous_Rabs x : continuous Rabs x.
Proof. apply continuity_pt_filterlim. apply Rcontinuity_abs. Qed.

Lemma Rmax_is x y : Rmax x y = (x + y + Rabs (x - y)) / 2.
Proof. unfold Rmax, Rabs. destruct (Rle_dec x y), (Rcase_abs (x - y)); lra. Qed.
Lemma Rmin_is x y : Rmin x y = (x + y - Rabs (x - y)) / 2.
Proof. unfold Rmin, Rabs. destruct (Rle_dec x y), (Rcase_abs (x - y)); lra. Qed.

Section Rules.
Context {U : UniformSpace}.
Implicit Types h k : U -> R -> R.

Lemma c_ext h k : (forall w x, h w x = k w x) -> continuous_2 h -> continuous_2 k.
Proof.
  intros E H w x. apply (continuous_ext (fun q : U * R => h (fst q) (snd q))); [|apply (H w x)].
  intros q. apply E.
Qed.
Lemma c_fst (phi : U -> R) : (forall w, continuous phi w) -> continuous_2 (fun w _ => phi w).
Proof. intros H w x. apply (continuous_comp (fun q : U * R => fst q) phi); [apply continuous_fst|apply H]. Qed.
Lemma c_snd : continuous_2 (fun (_ : U) x => x).
Proof. intros w x. apply continuous_snd. Qed.
Lemma c_const c : continuous_2 (fun (_ : U) _ => c).
Proof. intros w x. apply continuous_const. Qed.
Lemma c_comp (phi : R -> R) h : (forall x, continuous phi x) -> continuous_2 h -> continuous_2 (fun w x => phi (h w x)).
Proof. intros P H w x. apply (continuous_comp (fun q : U * R => h (fst q) (snd q)) phi); [apply (H w x)|apply P]. Qed.
Lemma c_plus h k : continuous_2 h -> continuous_2 k -> continuous_2 (fun w x => h w x + k w x).
Proof.
  intros H K w x. apply (continuous_plus (fun q : U * R => h (fst q) (snd q)) (fun q => k (fst q) (snd q)));
  [apply (H w x)|apply (K w x)].
Qed.
Lemma c_minus h k : continuous_2 h -> continuous_2 k -> continuous_2 (fun w x => h w x - k w x).
Proof.
  intros H K w x. apply (continuous_minus (fun q : U * R => h (fst q) (snd q)) (fun q => k (fst q) (snd q)));
  [apply (H w x)|apply (K w x)].
Qed.
Lemma c_opp h : continuous_2 h -> continuous_2 (fun w x => - h w x).
Proof. intros H w x. apply (continuous_opp (fun q : U * R => h (fst q) (snd q))). apply (H w x). Qed.
Lemma c_mult h k : continuous_2 h -> continuous_2 k -> continuous_2 (fun w x => h w x * k w x).
Proof.
  intros H K w x. apply (continuous_mult (fun q : U * R => h (fst q) (snd q)) (fun q => k (fst q) (snd q)));
  [apply (H w x)|apply (K w x)].
Qed.
Lemma c_div h k : (forall w x, k w x <> 0) -> continuous_2 h -> continuous_2 k -> continuous_2 (fun w x => h w x / k w x).
Proof.
  intros N H K. apply c_mult; [exact H|]. intros w x.
  apply (continuous_comp (fun q : U * R => k (fst q) (snd q)) Rinv); [apply (K w x)|apply continuous_Rinv, N].
Qed.
Lemma c_abs h : continuous_2 h -> continuous_2 (fun w x => Rabs (h w x)).
Proof. apply c_comp. exact continuous_Rabs. Qed.
Lemma c_max h k : continuous_2 h -> continuous_2 k -> continuous_2 (fun w x => Rmax (h w x) (k w x)).
Proof.
  intros H K. apply (c_ext (fun w x => (h w x + k w x + Rabs (h w x - k w x)) * / 2)).
  - intros w x. rewrite Rmax_is. reflexivity.
  - apply c_mult; [|apply c_const]. apply c_plus; [apply c_plus; assumption|]. apply c_abs, c_minus; assumption.
Qed.
Lemma c_min h k : continuous_2 h -> continuous_2 k -> continuous_2 (fun w x => Rmin (h w x) (k w x)).
Proof.
  intros H K. apply (c_ext (fun w x => (h w x + k w x - Rabs (h w x - k w x)) * / 2)).
  - intros w x. rewrite Rmin_is. reflexivity.
  - apply c_mult; [|apply c_const]. apply c_minus; [apply c_plus; assumption|]. apply c_abs, c_minus; assumption.
Qed.
Lemma c_atan h : continuous_2 h -> continuous_2 (fun w x => atan (h w x)).
Proof. apply c_comp. intros x. apply continuity_pt_filterlim, derivable_continuous_pt, derivable_pt_atan. Qed.
Lemma c_exp h : continuous_2 h -> continuous_2 (fun w x => exp (h w x)).
Proof. apply c_comp. intros x. apply continuity_pt_filterlim, derivable_continuous_pt, derivable_pt_exp. Qed.
Lemma c_sin h : continuous_2 h -> continuous_2 (fun w x => sin (h w x)).
Proof. apply c_comp. intros x. apply continuity_pt_filterlim, continuity_sin. Qed.
Lemma c_sqrt h : continuous_2 h -> continuous_2 (fun w x => sqrt (h w x)).
Proof. apply c_comp. intros x. apply continuous_sqrt. Qed.

Lemma c_clip01 h : continuous_2 h -> continuous_2 (fun w x => clip01 (h w x)).
Proof. intros H. apply c_max; [apply c_const|]. apply c_min; [apply c_const|exact H]. Qed.
End Rules.

Ltac cont1 := match goal with
  | H : continuous_2 ?f |- continuous_2 ?f => exact H
  | |- continuous_2 (fun w z => z) => apply c_snd
  | |- continuous_2 (fun w z => ?c) => apply (c_const c)
  | |- continuous_2 (fun w z => @?h w z + @?k w z) => apply (c_plus h k)
  | |- continuous_2 (fun w z => @?h w z - @?k w z) => apply (c_minus h k)
  | |- continuous_2 (fun w z => - @?h w z) => apply (c_opp h)
  | |- continuous_2 (fun w z => @?h w z * @?k w z) => apply (c_mult h k)
  | |- continuous_2 (fun w z => @?h w z / ?k) => apply (c_mult h (fun _ _ => / k))
  | |- continuous_2 (fun w z => @?h w z / @?k w z) => apply (c_div h k)
  | |- continuous_2 (fun w z => Rabs (@?h w z)) => apply (c_abs h)
  | |- continuous_2 (fun w z => atan (@?h w z)) => apply (c_atan h)
  | |- continuous_2 (fun w z => exp (@?h w z)) => apply (c_exp h)
  | |- continuous_2 (fun w z => sin (@?h w z)) => apply (c_sin h)
  | |- continuous_2 (fun w z => sqrt (@?h w z)) => apply (c_sqrt h)
  | |- continuous_2 (fun w z => clip01 (@?h w z)) => apply (c_clip01 h)
  | |- continuous_2 (fun w z => Rmax (@?h w z) (@?k w z)) => apply (c_max h k)
  | |- continuous_2 (fun w z => Rmin (@?h w z) (@?k w z)) => apply (c_min h k)
  end.
Ltac cont := repeat cont1.

(* --- the laws ------------------------------------------------------------------------------------------------------- *)
Section Laws.
Context {U : UniformSpace}.
Variables (p : constants) (vel Fc Fs : U -> R).
Hypothesis Hvel : forall w, continuous vel w.
Hypothesis HFc : forall w, continuous Fc w.
Hypothesis HFs : forall w, continuous Fs w.
Hypothesis Hs0 : 0 < sigma_0 p.
Hypothesis Hlevel : forall w, 0 < Fc w <= Fs w.
Let q (w : U) := at_level p (Fc w) (Fs w).

Let cv : continuous_2 (fun w (_ : R) => vel w). Proof. apply c_fst, Hvel. Qed.
Let cc : continuous_2 (fun w (_ : R) => Fc w). Proof. apply c_fst, HFc. Qed.
Let cs : continuous_2 (fun w (_ : R) => Fs w). Proof. apply c_fst, HFs. Qed.

Lemma c_g : continuous_2 (fun w _ => g (q w) (vel w)).
Proof. unfold g, q; simpl. cont. Qed.

Lemma g_not_0 w : g (q w) (vel w) <> 0.
Proof. apply Rgt_not_eq. apply g_pos; simpl; auto; apply Hlevel. Qed.

Lemma c_S_0 : continuous_2 (fun w _ => S_0 p (vel w)).
Proof. unfold S_0. cont. Qed.
Lemma c_m_atan : continuous_2 (fun w _ => m_atan p (vel w)).
Proof. unfold m_atan. cont. apply c_S_0. Qed.
Lemma c_m_sqrt : continuous_2 (fun w _ => m_sqrt p (vel w)).
Proof. unfold m_sqrt. cont. Qed.
Lemma c_m_compact : 0 < k_v p -> continuous_2 (fun w _ => m_compact p (vel w)).
Proof.
  intros Hk. set (k := k_v p) in *.
  pose (x := fun w : U => Rmax 0 (1 - k * Rabs (vel w))).
  apply (c_ext (fun w _ => Rabs (vel w) + x w * (x w * x w) * (3 + k * Rabs (vel w)) * / (8 * k))).
  - intros w _. rewrite m_compact_is by exact Hk. unfold x. fold k. destruct (Rlt_dec (k * Rabs (vel w)) 1) as [L | L].
    + rewrite Rmax_right by lra.
      assert (V : vel w * vel w = Rabs (vel w) * Rabs (vel w)) by (rewrite <- Rabs_mult; symmetry; apply Rabs_pos_eq; nra).
      rewrite V. field. lra.
    + rewrite Rmax_left by lra. ring.
  - unfold x. cont.
Qed.

Hypothesis Hb : forall w, z_ba p * sigma_0 p < Fc w.

Lemma c_yielded : continuous_2 (fun w z => yielded (q w) (vel w) z).
Proof.
  apply (c_ext (fun w z => (Rabs z - z_ba p) / (g (q w) (vel w) - z_ba p))); [reflexivity|].
  pose proof c_g. cont. intros w _. apply Rgt_not_eq, Rlt_gt.
  enough (z_ba (q w) < g (q w) (vel w)) by (simpl in *; lra).
  apply z_ba_below; simpl; auto. apply Hlevel.
Qed.

Lemma c_share_smooth : continuous_2 (fun w z => a (q w) (vel w) z).
Proof.
  apply (c_ext (fun w z => smoothstep (yielded (q w) (vel w) z))); [intros; symmetry; apply a_is|].
  unfold smoothstep. pose proof c_yielded. cont.
Qed.

Lemma c_share_sine : continuous_2 (fun w z => alpha_0 (q w) (vel w) z).
Proof.
  apply (c_ext (fun w z => sine_step (yielded (q w) (vel w) z))).
  - intros w z. symmetry. apply alpha_0_is. apply z_ba_below; simpl; auto; apply Hlevel.
  - unfold sine_step. pose proof c_yielded. cont.
Qed.
End Laws.

(* dz/dt of each law, where velocity and level may vary. *)
Section Rates.
Context {U : UniformSpace}.
Variables (p : constants) (vel Fc Fs : U -> R).
Hypothesis Hvel : forall w, continuous vel w.
Hypothesis HFc : forall w, continuous Fc w.
Hypothesis HFs : forall w, continuous Fs w.
Hypothesis Hs0 : 0 < sigma_0 p.
Hypothesis Hlevel : forall w, 0 < Fc w <= Fs w.
Let q (w : U) := at_level p (Fc w) (Fs w).
Let cv : continuous_2 (fun w (_ : R) => vel w). Proof. apply c_fst, Hvel. Qed.
Let cg := c_g p vel Fc Fs Hvel HFc HFs.
Let g0 := g_not_0 p vel Fc Fs Hs0 Hlevel.

Lemma c_lugre : continuous_2 (fun w z => lugre.dz_dt (q w) (vel w) z).
Proof. unfold lugre.dz_dt. pose proof cg. cont; intros; apply g0. Qed.
Lemma c_lugre_arctan : continuous_2 (fun w z => lugre_arctan.dz_dt (q w) (vel w) z).
Proof. unfold lugre_arctan.dz_dt. pose proof (c_S_0 p vel Hvel). pose proof cg. cont; intros; apply g0. Qed.
Lemma c_lugre_sobczyk : continuous_2 (fun w z => lugre_sobczyk.dz_dt (q w) (vel w) z).
Proof. unfold lugre_sobczyk.dz_dt. pose proof (c_S_0 p vel Hvel). pose proof cg. cont; intros; apply g0. Qed.
Lemma c_lugre_majorant : continuous_2 (fun w z => lugre_majorant.dz_dt (q w) (vel w) z).
Proof. unfold lugre_majorant.dz_dt. pose proof (c_m_atan p vel Hvel). pose proof cg. cont; intros; apply g0. Qed.
Lemma c_lugre_majorant_sqrt : continuous_2 (fun w z => lugre_majorant_sqrt.dz_dt (q w) (vel w) z).
Proof. unfold lugre_majorant_sqrt.dz_dt. pose proof (c_m_sqrt p vel Hvel). pose proof cg. cont; intros; apply g0. Qed.
Lemma c_lugre_majorant_compact : 0 < k_v p -> continuous_2 (fun w z => lugre_majorant_compact.dz_dt (q w) (vel w) z).
Proof.
  intros Hk. unfold lugre_majorant_compact.dz_dt. pose proof (c_m_compact p vel Hvel Hk). pose proof cg.
  cont; intros; apply g0.
Qed.

Hypothesis Hb : forall w, z_ba p * sigma_0 p < Fc w.
Let ca := c_share_smooth p vel Fc Fs Hvel HFc HFs Hs0 Hlevel Hb.
Let c0 := c_share_sine p vel Fc Fs Hvel HFc HFs Hs0 Hlevel Hb.

Lemma c_elastoplastic_sobczyk : continuous_2 (fun w z => elastoplastic_sobczyk.dz_dt (q w) (vel w) z).
Proof.
  unfold elastoplastic_sobczyk.dz_dt. pose proof (c_S_0 p vel Hvel). pose proof c0. pose proof cg.
  cont; intros; apply g0.
Qed.
Lemma c_elastoplastic_majorant : continuous_2 (fun w z => elastoplastic_majorant.dz_dt (q w) (vel w) z).
Proof.
  unfold elastoplastic_majorant.dz_dt. pose proof (c_m_atan p vel Hvel). pose proof ca. pose proof cg.
  cont; intros; apply g0.
Qed.
Lemma c_elastoplastic_majorant_sqrt : continuous_2 (fun w z => elastoplastic_majorant_sqrt.dz_dt (q w) (vel w) z).
Proof.
  unfold elastoplastic_majorant_sqrt.dz_dt. pose proof (c_m_sqrt p vel Hvel). pose proof ca. pose proof cg.
  cont; intros; apply g0.
Qed.
Lemma c_elastoplastic_majorant_compact : 0 < k_v p ->
  continuous_2 (fun w z => elastoplastic_majorant_compact.dz_dt (q w) (vel w) z).
Proof.
  intros Hk. unfold elastoplastic_majorant_compact.dz_dt. pose proof (c_m_compact p vel Hvel Hk). pose proof ca. pose proof cg.
  cont; intros; apply g0.
Qed.

(* The rule on signs leaves no jump: alpha |v| z = alpha_0 (|v| z + v |z|)/2. *)
Lemma sign_rule w z : alpha (q w) (vel w) z * Rabs (vel w) * z =
  alpha_0 (q w) (vel w) z * ((Rabs (vel w) * z + vel w * Rabs z) * / 2).
Proof.
  unfold alpha. destruct (Rle_dec (vel w * z) 0) as [L | L].
  - replace (Rabs (vel w) * z + vel w * Rabs z) with 0; [ring|].
    unfold Rabs. destruct (Rcase_abs (vel w)), (Rcase_abs z); nra.
  - replace (vel w * Rabs z) with (Rabs (vel w) * z); [field|].
    unfold Rabs. destruct (Rcase_abs (vel w)), (Rcase_abs z); nra.
Qed.

Lemma c_elastoplastic : continuous_2 (fun w z => elastoplastic.dz_dt (q w) (vel w) z).
Proof.
  apply (c_ext (fun w z =>
    vel w - alpha_0 (q w) (vel w) z * ((Rabs (vel w) * z + vel w * Rabs z) * / 2) / g (q w) (vel w))).
  - intros w z. rewrite <- sign_rule. unfold elastoplastic.dz_dt. field. apply g0.
  - pose proof c0. pose proof cg. cont; intros; apply g0.
Qed.
End Rates.
